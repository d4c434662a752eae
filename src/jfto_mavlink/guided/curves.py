"""The curves of a fleet: held whole from the start, and replaced all at once by newer ones."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from jfto_mavlink.errors import FlightError
from jfto_mavlink.guided.reference import reference
from jfto_msgs_py.records.vehicle import TimedTrajectory
from jfto_msgs_py.types import Array

# A start further ahead than this is no time that anybody has named: lift-off is awaited.
AWAITED_S = 600.0
# Where vehicles stand is looked for so finely, s along their curves.
_LOOK_S = 0.1


class Curves:
    """`held` are flown; those that have come since are waiting until they are complete.

    One planning's curves begin together: a fleet that mixed them would not keep its distances.
    `check` raises MissionError for a curve that a UAV cannot fly.
    """

    def __init__(self, uavs: Sequence[str], check: Callable[[str, TimedTrajectory], None]) -> None:
        self._uavs, self._check = tuple(uavs), check
        self._come: dict[str, TimedTrajectory] = {}
        self.held: dict[str, TimedTrajectory] = {}

    def take(self, uav: str, curve: TimedTrajectory) -> bool:
        """A UAV's curve has come; whether the newest are complete, and others than those held.

        Raises MissionError where it cannot be flown; then those held stay.
        """
        self._check(uav, curve)
        self._come[uav] = curve
        starts = {each.start_ns for each in self._come.values()}
        complete = len(self._come) == len(self._uavs) and len(starts) == 1
        return complete and not self._known()

    def _known(self) -> bool:
        return bool(self.held) and all(_alike(self.held[u], self._come[u]) for u in self._uavs)

    @property
    def newest(self) -> dict[str, TimedTrajectory]:
        """The curves that have come last."""
        return dict(self._come)

    def hold(self, curves: Mapping[str, TimedTrajectory]) -> None:
        """Fly these from now on."""
        self.held = dict(curves)

    def require(self) -> None:
        """Raise FlightError 601 while there is not a curve for everybody."""
        missing = [uav for uav in self._uavs if uav not in self.held]
        if missing:
            raise FlightError(
                601,
                f"{', '.join(missing)}: no trajectory has come yet, of one planning for all. Is "
                "the planner up?",
            )

    @property
    def end_s(self) -> float:
        """From time zero until the last UAV is at the end of its curve."""
        return max(int(each.offset_ns[-1]) for each in self.held.values()) / 1e9

    def places(self, uav: str, elapsed_s: Array) -> Array:
        """Positions (T, 3) of a UAV along its curve."""
        curve = self.held[uav]
        at_ns = curve.start_ns + np.rint(elapsed_s * 1e9).astype(np.int64)
        return reference(curve, at_ns).position_m

    def standing_at(
        self, here_m: Mapping[str, Array], since_s: float, until_s: float
    ) -> tuple[float, dict[str, float]]:
        """Between two times along the curves, that at which UAVs are nearest to where they stand.

        Returns it with the distance of each, m. `here_m` must not be empty.
        """
        count = max(int((until_s - since_s) / _LOOK_S), 0) + 2
        times = np.linspace(max(since_s, 0.0), max(until_s, since_s, 0.0), count)
        away = {
            uav: np.linalg.norm(self.places(uav, times) - place, axis=1)
            for uav, place in here_m.items()
        }
        best = int(np.argmin(np.sum(np.square(np.stack(list(away.values()))), axis=0)))
        return float(times[best]), {uav: float(each[best]) for uav, each in away.items()}


def _alike(one: TimedTrajectory, other: TimedTrajectory) -> bool:
    """Whether two have the same shape, whenever they begin."""
    return all(
        np.array_equal(getattr(one, name), getattr(other, name))
        for name in ("offset_ns", "position_m", "velocity_mps", "acceleration_mps2")
    )
