"""The routing problem (P1): which UAV visits which waypoint in which order."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.types import Array, Flags
from jfto_msgs_py.whole_numbers import whole_number
from jfto_planner.routing.detours import Detours
from jfto_world.motion import ConstantSpeed, MotionLimits, TimeModel

EnergyFloor = Callable[[Array, float], Array]

# Sets of UAVs are the bits of one machine word.
MOST_UAVS = 64
# Limits that bind nothing, for problems that are not about them.
A_DAY_S = 86_400.0
ANY_LENGTH_M = 1e9


@dataclass(frozen=True)
class RoutingProblem:
    """Everything that (P1) depends on.

    Four fields make a problem, the others have defaults:

    >>> import numpy as np
    >>> from jfto_planner import RoutingProblem, SearchSettings, search
    >>> waypoints, starts = np.random.default_rng(0).uniform(0, 900, (40, 3)), 100 * np.eye(3)
    >>> problem = RoutingProblem(waypoints, starts, reach_m=np.array([900.0]), k_min=1)
    >>> found = search(problem, SearchSettings(moves=100_000), seed=1)

    Parameters
    ----------
    waypoints_m, starts_m
        Waypoints (W, 3) and one pad per UAV (A, 3), ENU metres.
    reach_m
        Greatest link distance at the highest power, (A,) or one for all; a pair has the lesser of
        both.
    k_min
        Least neighbours of every UAV at every instant (P1kmin), below A.
    limits
        Speeds of each UAV, or of all where there is one. Default: those of a scenario, 10 m/s,
        4 m/s up and 3 m/s down.
    time_model
        How speeds turn into times along a route. Default: straight legs at constant speed.
    t_max_s
        Latest arrival at the last waypoint, (A,) or one for all, T_a,max (P1tmax). Default: a day.
    d_min_m
        Least separation (P0avoid); 0 leaves it out.
    length_max_m
        Greatest length of all routes together, L_max (P0length).
    slot_count, horizon_s
        N, and T in seconds or None for the makespan.
    energy_j, energy_floor
        Budget (A,) in joules, and what the topology of positions (N + 1, A, 3) over slots of a
        duration in seconds costs at least, (A,) joules; None leaves energy out. It is called from
        several threads.
    path_loss_exponent
        Exponent of distance in the power a link needs; guides the search in saving energy.
    most_waypoints
        How many waypoints a route may have, (A,) or one for all; None for any.
    closed_legs
        Legs that must not be flown, symmetric (W + A, W + A), waypoints before pads, or None.
    detours
        Legs that go round no-fly zones, of the same nodes; None where all are straight.

    Raises
    ------
    InputError
        Naming the field whose shape or value is wrong.
    """

    waypoints_m: Array
    starts_m: Array
    reach_m: Array
    k_min: int
    limits: tuple[MotionLimits, ...] = (MotionLimits(10.0, 4.0, 3.0),)
    time_model: TimeModel = ConstantSpeed()  # noqa: RUF009  it has no state
    t_max_s: Array = field(default_factory=lambda: np.array([A_DAY_S]))
    d_min_m: float = 0.0
    length_max_m: float = ANY_LENGTH_M
    slot_count: int = 150
    horizon_s: float | None = None
    energy_j: Array | None = None
    energy_floor: EnergyFloor | None = None
    path_loss_exponent: float = 2.0
    closed_legs: Flags | None = None
    detours: Detours | None = None
    most_waypoints: Array | None = None

    def __post_init__(self) -> None:
        for name in ("waypoints_m", "starts_m"):
            object.__setattr__(self, name, _points(name, getattr(self, name)))
        if not 1 <= self.uav_count <= MOST_UAVS:
            raise InputError(
                f"starts_m has {self.uav_count} pads; the search takes 1 to {MOST_UAVS} UAVs."
            )
        if len(self.limits) == 1:
            object.__setattr__(self, "limits", self.limits * self.uav_count)
        if len(self.limits) != self.uav_count:
            raise InputError(f"limits has {len(self.limits)} entries for {self.uav_count} UAVs.")
        for name in ("t_max_s", "reach_m", "energy_j", "most_waypoints"):
            if getattr(self, name) is not None:
                values = _per_uav(name, getattr(self, name), self.uav_count)
                object.__setattr__(self, name, values)
        self._check_scalars()

    @property
    def uav_count(self) -> int:
        """A, the number of UAVs."""
        return len(self.starts_m)

    @property
    def waypoint_count(self) -> int:
        """W, the number of waypoints."""
        return len(self.waypoints_m)

    @property
    def nodes_m(self) -> Array:
        """Waypoints, then pads (W + A, 3)."""
        return np.concatenate([self.waypoints_m, self.starts_m])

    @property
    def latest_arrival_s(self) -> Array:
        """Latest permitted arrival (A,): T_a,max, or the given horizon where that is shorter."""
        return self.t_max_s if self.horizon_s is None else np.minimum(self.t_max_s, self.horizon_s)

    @property
    def pair_reach_m(self) -> Array:
        """Greatest link distance of each pair (A, A), the lesser of both ranges."""
        return np.minimum(self.reach_m[:, None], self.reach_m[None, :])

    def line_m(self, uav: int, route: Sequence[int]) -> Array:
        """Pad, waypoints and what detours pass (K, 3) of a route, in order."""
        nodes = self.nodes_m[[self.waypoint_count + uav, *route]]
        if self.detours is None:
            return nodes
        pieces = [nodes[:1]]
        for k, (here, there) in enumerate(self.legs_of(uav, route), start=1):
            pieces += [self.detours.between(here, there), nodes[k : k + 1]]
        return np.concatenate(pieces)

    def legs_of(self, uav: int, route: Sequence[int]) -> list[tuple[int, int]]:
        """Legs of a route as pairs of nodes."""
        return list(pairwise([self.waypoint_count + uav, *route]))

    def _check_scalars(self) -> None:
        object.__setattr__(self, "k_min", whole_number("k_min", self.k_min))
        if not 0 <= self.k_min < self.uav_count:
            raise InputError(
                f"k_min is {self.k_min}, but {self.uav_count} UAVs can have at most "
                f"{self.uav_count - 1} neighbours each; use 0 to {self.uav_count - 1}."
            )
        for name in ("length_max_m", "path_loss_exponent"):
            if not getattr(self, name) > 0:
                raise InputError(f"{name} is {getattr(self, name)}, must be positive.")
        if not 0 <= self.d_min_m < np.inf:
            raise InputError(f"d_min_m is {self.d_min_m}, must be 0 or more.")
        if self.slot_count < 1:
            raise InputError(f"slot_count is {self.slot_count}, must be at least 1.")
        if self.horizon_s is not None and not 0 < self.horizon_s < np.inf:
            raise InputError(f"horizon_s is {self.horizon_s}, must be positive or None.")
        if (self.energy_floor is None) != (self.energy_j is None):
            raise InputError("energy_j and energy_floor must be given together, or neither.")


def _points(name: str, value: Array) -> Array:
    points = np.array(value, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) == 0:
        raise InputError(f"{name} has shape {points.shape}, must be (count, 3), count at least 1.")
    if not np.isfinite(points).all():
        row = int(np.argmin(np.isfinite(points).all(axis=1)))
        raise InputError(f"{name}[{row}] is {points[row].tolist()}, must be finite.")
    points.setflags(write=False)
    return points


def _per_uav(name: str, value: Array, uav_count: int) -> Array:
    values = np.array(value, dtype=np.float64)
    if values.size == 1:
        values = np.full(uav_count, values.item())
    if values.shape != (uav_count,):
        raise InputError(
            f"{name} has shape {values.shape}, must be ({uav_count},), one per UAV, or one for all."
        )
    bad = ~((values > 0) & np.isfinite(values))
    if bad.any():
        a = int(np.argmax(bad))
        raise InputError(f"{name}[{a}] is {values[a]}, must be positive and finite.")
    values.setflags(write=False)
    return values
