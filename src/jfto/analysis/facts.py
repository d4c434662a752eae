"""A flight held against its plan: everything that a report says of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from jfto.analysis.causes import Explainer
from jfto.analysis.certificate import FlownCertificate, FlownException, flown_certificate
from jfto.analysis.comparison import AlgorithmResult, Comparison
from jfto.analysis.endings import LANDED, Ending, endings_of, left_the_ground
from jfto.analysis.grid import FINER, FlownGrid, PlannedFlight, flown_grid, planned_flight
from jfto.analysis.network import (
    EnergyUse,
    FlownNetwork,
    PlannedAgainstFlown,
    against_plan,
    energy_use,
    flown_network,
)
from jfto.analysis.passages import UavTiming, finished_s, passages_of, timing_of
from jfto.analysis.record import RecordedFlight
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.passage import Passage
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.scenario import Scenario
from jfto_msgs_py.types import Array
from jfto_world.terrain import Dem

# A flight with this share of clean slots is called good; every other slot is explained.
CLEAN_SHARE = 0.99
# Lower than this above its pad a UAV stands on it.
ON_PAD_M = 0.3


@dataclass(frozen=True, eq=False)
class FlightFacts:
    """`end_s` is when the last waypoint was passed, seconds after lift-off; `planned` is C-TOP's
    result at the desk, `desk` the flight as planned.
    """

    plan: Plan
    planned: AlgorithmResult
    desk: PlannedFlight
    flight: RecordedFlight
    grid: FlownGrid
    end_s: float
    passages: tuple[Passage, ...]
    certificate: FlownCertificate
    network: FlownNetwork
    throughput: PlannedAgainstFlown
    energy: tuple[EnergyUse, ...]
    endings: tuple[Ending, ...]

    @property
    def good(self) -> bool:
        """All waypoints visited in time, all landed, no energy overdrawn, slots as good as clean.

        In time is within a slot: slots wait for a fleet that is late, and are clean all the same.
        """
        return (
            abs(self.worst_late_s) <= self.plan.slots.duration_s
            and self.visited == len(self.passages)
            and all(one.how == LANDED for one in self.endings)
            and not any(one.overdraft_j > 0 for one in self.energy)
            and self.certificate.clean_share >= CLEAN_SHARE
        )

    @property
    def visited(self) -> int:
        """Waypoints that were passed closely enough."""
        return sum(one.visited for one in self.passages)

    @property
    def worst_late_s(self) -> float:
        """The timing error of greatest size over all waypoints visited, 0 without any."""
        late = [one.late_s for one in self.passages if one.visited and one.late_s is not None]
        return max(late, key=abs, default=0.0)

    @property
    def shifted(self) -> str:
        """By how much the slots were later than planned, "" where nobody was late by one."""
        if self.worst_late_s <= self.plan.slots.duration_s / 2:
            return ""
        return f" but up to {self.worst_late_s:.1f} s later than planned"

    @property
    def slots_in_words(self) -> str:
        """How many slots are clean, and how many nothing is known of."""
        share = f"{100 * self.certificate.clean_share:.1f} %"
        missing = self.plan.slots.count - self.grid.slots
        if missing <= 0:
            return f"{share} of slots clean"
        return (
            f"{share} of the {self.grid.slots} slots on record clean, the other {missing} of "
            f"{self.plan.slots.count} not flown or not recorded"
        )

    @property
    def worst_closest_m(self) -> float:
        """The greatest distance at which a waypoint was passed."""
        return max((one.closest_m for one in self.passages), default=0.0)

    def in_words(self) -> str:
        """How well it went, in one line."""
        away_m = self.worst_closest_m
        away = f"{away_m:.1f} m" if np.isfinite(away_m) else "some never passed"
        return (
            f"worst {self.worst_late_s:+.1f} s and {away}, "
            f"{self.slots_in_words}{self.shifted}, "
            f"{self.throughput.in_words}"
        )

    @property
    def landed_s(self) -> float | None:
        """When the last UAV was last seen above its pad, s from lift-off; None before that."""
        if not all(one.how == LANDED for one in self.endings):
            return None
        last_s = 0.0
        for uav in self.plan.uavs:
            track = self.flight.tracks[uav.id]
            up = track.position_m[:, 2] - uav.start_m[2] > ON_PAD_M
            last_s = max(last_s, float(track.times_s[up].max(initial=0.0)))
        return last_s

    @property
    def timing(self) -> tuple[UavTiming, ...]:
        """How each UAV kept to its waypoints."""
        return tuple(timing_of(uav.id, self.passages) for uav in self.plan.uavs)

    @property
    def least_energy_left(self) -> float:
        """Share of its budget that the UAV with the least has left."""
        return min((1 - one.used_j / one.budget_j for one in self.energy), default=0.0)

    @property
    def least_return_gap_m(self) -> float:
        """The least distance between two UAVs on the way home, inf where nobody met."""
        return min((one.return_gap_m for one in self.endings), default=np.inf)


def flight_facts(
    bags: Sequence[Path], plan: Plan, comparison: Comparison, dem: Dem | None, scenario: Scenario
) -> FlightFacts:
    """The flight of a plan in its bags, held against it.

    Raises BagError where none of them is a bag, InputError where they hold no flight.
    """
    # Loaded here: a report of the plan alone reads no bag.
    from jfto.analysis.read_bag import read_flight

    flight = read_flight(bags, plan)
    if not left_the_ground(flight, plan):
        raise InputError(f"{bags[0]}: nobody left the ground. The report is of the plan alone.")
    # Legs of the autopilot are kept clear of the ground at upload, by no set height.
    guided = scenario.trajectory.mode == "guided"
    clearance_m = scenario.trajectory.clearance_m if guided else 0.0
    n_dc = scenario.evaluation.n_dc
    return facts_of(flight, plan, comparison.ours, dem, n_dc=n_dc, clearance_m=clearance_m)


def facts_of(
    flight: RecordedFlight,
    plan: Plan,
    planned: AlgorithmResult,
    dem: Dem | None,
    *,
    n_dc: int,
    clearance_m: float,
) -> FlightFacts:
    """Hold a flight against its plan.

    `dem` is None where the terrain is unknown; `clearance_m` is the least height over it away from
    the pads. Raises InputError where the record holds no pose after lift-off.
    """
    passages = passages_of(flight, plan)
    done = finished_s(passages)
    end_s = max(done.values(), default=plan.slots.horizon_s)
    grid = flown_grid(flight, plan, end_s)
    if grid.slots < plan.slots.count:
        short = f"the record ends in slot {grid.slots} of {plan.slots.count}"
        flight = replace(flight, notes=(*flight.notes, short))
    certificate = flown_certificate(plan, grid, _heights(grid, dem), clearance_m)
    energy = energy_use(flight, plan, planned, float(grid.times_s[-1]))
    desk = planned_flight(plan)
    explainer = Explainer(plan, flight, grid, passages, desk)
    exceptions = [*certificate.exceptions, *_overdrafts(energy, grid)]
    certificate = replace(
        certificate, exceptions=tuple(explainer.explained(one) for one in exceptions)
    )
    network = flown_network(flight, plan, grid, n_dc)
    return FlightFacts(
        plan=plan,
        planned=planned,
        desk=desk,
        flight=flight,
        grid=grid,
        end_s=end_s,
        passages=passages,
        certificate=certificate,
        network=network,
        throughput=against_plan(planned, network),
        energy=energy,
        endings=endings_of(flight, plan, end_s),
    )


def _heights(grid: FlownGrid, dem: Dem | None) -> Array:
    """Height over ground or surface (T, A), nan where a UAV was never seen or is beyond the DEM."""
    if dem is None:
        return np.full(grid.position_m.shape[:2], np.nan)
    east, north, up = np.moveaxis(grid.position_m, 2, 0)
    half_east, half_north = dem.half_extent_m
    with np.errstate(invalid="ignore"):
        inside = (np.abs(east) <= half_east) & (np.abs(north) <= half_north)
    ground = dem.top_height(np.where(inside, east, 0.0), np.where(inside, north, 0.0))
    return np.where(inside, up - ground, np.nan)


def _overdrafts(energy: tuple[EnergyUse, ...], grid: FlownGrid) -> list[FlownException]:
    found = []
    last = (len(grid.times_s) - 1) / FINER
    for one in energy:
        if one.overdraft_j > 0:
            message = f"{one.uav} used {one.used_j:.1f} J for transmitting and had {one.budget_j:g}"
            end_s = float(grid.times_s[-1])
            found.append(
                FlownException(
                    "energy", one.uav, last, last, end_s, one.used_j, one.budget_j, None, message
                )
            )
    return found
