"""Several flights where one does not do: waypoints divided, each sortie a plan of its own."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jfto.console.progress import SILENT, Progress
from jfto.planning.endurance import longest_arrivals_s
from jfto.planning.problem import pads_of
from jfto.planning.routes import Planned, plan_routes
from jfto.planning.speeds import fleet_limits, speed_notes
from jfto.planning.survey import Survey
from jfto_msgs_py.errors import InfeasibleError
from jfto_msgs_py.plan_file import rounded_record
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.records.site import Sortie
from jfto_msgs_py.scenario import Scenario
from jfto_msgs_py.types import Array, Ints
from jfto_planner.sorties import Load, Split, balanced, least_by_time
from jfto_planner.sorties.balance import BROKEN
from jfto_world.motion.battery import airborne, drain_of

# Rules that fewer waypoints in a flight are a cure for.
CURABLE = {"duration", "endurance", "battery", "energy", "total_length", "items"}
# A division is tried with so much fewer moves, but so many at least.
TRIAL_SHARE, TRIAL_LEAST = 8, 300_000
# What is expected of the next number of sorties when this one was too full, on the low side.
CAREFUL = 0.9


@dataclass(frozen=True)
class PlannedSorties:
    """One plan for each flight; several are clean, one alone may be the closest to it.

    `least` is how many it takes at least, by the time that legs between waypoints take.
    """

    sorties: tuple[Planned, ...]
    least: int = 1

    @property
    def plans(self) -> tuple[Plan, ...]:
        """The plans, in the order in which they are flown."""
        return tuple(planned.plan for planned in self.sorties)

    @property
    def interrupted(self) -> bool:
        """Whether a search was stopped before its budget."""
        return any(planned.interrupted for planned in self.sorties)


def plan_sorties(
    scenario: Scenario, found: Survey, progress: Progress = SILENT, warm_start: Plan | None = None
) -> PlannedSorties:
    """Plan as many flights as scenario part sorties says, or as few as are found to do.

    One flight is tried first, from `warm_start` where given, unless its time cannot do. Where no
    division does, it is the answer, with its violations. Raises InfeasibleError where there is
    nothing to show, KeyboardInterrupt where the user stops before anything is clean.
    """
    if scenario.sorties.count == 1 or warm_start is not None:
        return PlannedSorties((plan_routes(scenario, found, progress, warm_start),))
    trials = _Trials(scenario, found, progress)
    if scenario.sorties.count:
        return trials.exactly(scenario.sorties.count)
    least = least_sorties(scenario, found)
    alone: Planned | InfeasibleError | None = None
    everything = trials.part(np.arange(len(found.waypoints)))
    if least == 1:
        try:
            alone = plan_routes(scenario, everything, progress)
        except InfeasibleError as error:
            alone = error
        else:
            kinds = {violation.kind for violation in alone.certificate.violations}
            if alone.plan.clean or alone.interrupted or not kinds & CURABLE:
                return PlannedSorties((alone,))
    else:
        for note in speed_notes(scenario):
            progress.warn(note)
    several = trials.as_few_as_do(least)
    if several is not None:
        return replace(several, least=least)
    progress.warn(
        f"No division into up to {scenario.sorties.most} sorties (sorties.most) was found in which "
        "each keeps every rule."
    )
    if isinstance(alone, InfeasibleError):
        raise alone
    return PlannedSorties((alone or plan_routes(scenario, everything, progress),), least)


def least_sorties(scenario: Scenario, found: Survey) -> int:
    """How many sorties it takes at least by time."""
    waypoints = np.array([waypoint.position_m for waypoint in found.waypoints])
    latest_s = longest_arrivals_s(scenario)
    return least_by_time(waypoints, fleet_limits(scenario), latest_s, scenario.trajectory.hold_s)


def sortie_survey(scenario: Scenario, found: Survey, group: Ints, same_m: Array | None) -> Survey:
    """The survey with the waypoints of one sortie (indices), and where it begins.

    That is the nearest of sorties.positions_m, else `same_m` (S, 2) where all begin alike.
    """
    waypoints = tuple(found.waypoints[index] for index in group)
    places = np.array(scenario.sorties.positions_m).reshape(-1, 2)
    starts_m = same_m
    if len(places):
        middle = np.mean([waypoint.position_m[:2] for waypoint in waypoints], axis=0)
        nearest = int(np.argmin(np.hypot(*(places - middle).T)))
        starts_m = places[nearest : nearest + 1]
    return replace(found, waypoints=waypoints, coverage=None, starts_m=starts_m)


class _Trials:
    """Divisions of the waypoints, tried by short searches; those that do, planned whole."""

    def __init__(self, scenario: Scenario, found: Survey, progress: Progress) -> None:
        self._scenario, self._found, self._progress = scenario, found, progress
        wanted = scenario.search
        moves = min(wanted.moves, max(wanted.moves // TRIAL_SHARE, TRIAL_LEAST))
        self._short = replace(scenario, search=replace(wanted, moves=moves))
        self._places = np.array([waypoint.position_m for waypoint in found.waypoints])
        self._planned: dict[bytes, Planned] = {}
        self._same_m: Array | None = None
        self._count = 1
        if scenario.sorties.starts == "same" and not scenario.sorties.positions_m:
            self._same_m = np.array(rounded_record(pads_of(scenario, found)[:, :2]))

    def part(self, group: Ints) -> Survey:
        """The survey of one sortie."""
        several = len(group) < len(self._places)
        same_m = self._same_m if several else None
        return sortie_survey(self._scenario, self._found, group, same_m)

    def exactly(self, count: int) -> PlannedSorties:
        """So many sorties; raises InfeasibleError where they are not found."""
        split = self._divided(count)
        if split.clean:
            return PlannedSorties(self._whole(split))
        broken = next(k for k, load in enumerate(split.loads) if not load.clean)
        planned = self._planned.get(split.groups[broken].tobytes())
        reason = "it cannot be begun"
        if planned is not None:
            reason = planned.certificate.violations[0].message
        raise InfeasibleError(
            f"sorties.count is {count}, but no division was found in which each sortie keeps every "
            f"rule; in the closest one, sortie {broken + 1}: {reason}.",
            cures=("sorties.count 0, which is as many as do", "more UAVs (fleet.count)"),
        )

    def as_few_as_do(self, least: int) -> PlannedSorties | None:
        """From 2 or `least` sorties upward; None where the smallest sortie is too much."""
        most = min(self._scenario.sorties.most, len(self._places))
        if most < 2 or not self._measure(self._hardest(most)).clean:
            return None
        count = max(least, 2)
        while count <= most:
            split = self._divided(count)
            if split.clean:
                return PlannedSorties(self._whole(split))
            full = float(np.mean([load.share for load in split.loads]))
            count = max(count + 1, int(CAREFUL * count * full))
        return None

    def _hardest(self, most: int) -> Ints:
        """A sortie of the fewest waypoints that sorties may have, farthest from the middle."""
        size = -(-len(self._places) // most)
        away = np.hypot(*(self._places - self._places.mean(axis=0))[:, :2].T)
        far = self._places[int(np.argmax(np.round(away, 6)))]
        near = np.round(np.hypot(*(self._places - far)[:, :2].T), 6)
        return np.sort(np.argsort(near, kind="stable")[:size])

    def _divided(self, count: int) -> Split:
        self._count = count
        self._progress.begin("sorties", f"dividing into {count}")
        return balanced(self._places, count, self._measure)

    def _measure(self, group: Ints) -> Load:
        self._progress.begin("sorties", f"{self._count} sorties: trying {len(group)} waypoints")
        try:
            planned = plan_routes(self._short, self.part(group), _Shares(self._progress))
        except InfeasibleError:
            return Load(BROKEN, clean=False, length_m=0.0)
        if planned.interrupted:
            raise KeyboardInterrupt
        # Made for the scenario as it is, only with a shorter search.
        plan = replace(planned.plan, scenario_hash=self._scenario.scenario_hash())
        self._planned[group.tobytes()] = replace(planned, plan=plan)
        return Load(fullness(plan), plan.clean, plan.total_length_m)

    def _whole(self, split: Split) -> tuple[Planned, ...]:
        """Each sortie by the whole search, or as tried where that found nothing clean."""
        count, stopped, found = len(split.groups), False, []
        for number, group in enumerate(split.groups, 1):
            planned = tried = self._planned[group.tobytes()]
            if not stopped:
                self._progress.begin(f"sortie {number}", f"searching, {number} of {count}")
                planned = plan_routes(self._scenario, self.part(group), _Shares(self._progress))
                stopped = planned.interrupted
            if not planned.plan.clean:
                planned = replace(tried, interrupted=stopped)
            plan = replace(planned.plan, sortie=Sortie(number, count))
            self._progress.end(f"sortie {number}", *_in_words(plan))
            found.append(replace(planned, plan=plan, interrupted=stopped))
        return tuple(found)


class _Shares(Progress):
    """Hands on how far a search is, and nothing of its stages."""

    def __init__(self, shown: Progress) -> None:
        self.advance: Callable[..., None] = shown.advance


def fullness(plan: Plan) -> float:
    """The share of what a plan's fleet may spend that it does: of time, endurance or battery."""
    return max(float(np.mean(shares)) for shares in _shares(plan) if len(shares))


def _shares(plan: Plan) -> Iterator[list[float]]:
    pairs = list(zip(plan.uavs, plan.routes, strict=True))
    yield [route.end_s / uav.t_max_s for uav, route in pairs]
    homes = zip(plan.uavs, plan.homes, strict=bool(plan.homes))
    yield [home.landed_s / uav.endurance_s for uav, home in homes if uav.endurance_s]
    drains = [(drain_of(plan, a), a) for a in range(len(plan.homes))]
    yield [
        drain.energy_wh(airborne(plan, a)) / drain.battery.usable_wh
        for drain, a in drains
        if drain is not None
    ]


def _in_words(plan: Plan) -> tuple[str, str]:
    detail = f"{plan.photo_count} waypoints, {100 * fullness(plan):.0f} % of what there is"
    return (
        f"{plan.total_length_m / 1000:.2f} km",
        f"{detail}, all landed after {plan.landed_s or 0.0:.0f} s",
    )


def faults_together(plans: Sequence[Plan]) -> tuple[str, ...]:
    """Why plans are not the sorties of one scenario with every waypoint in one; empty if they are.

    Places that routes merely pass do not count.
    """
    found = []
    first, numbers = plans[0], Counter(plan.sortie.number for plan in plans)
    count = max(plan.sortie.count for plan in plans)
    for plan in plans[1:]:
        if plan.scenario_hash != first.scenario_hash:
            found.append(f"sortie {plan.sortie.number} was planned for another scenario")
    for number in range(1, count + 1):
        if numbers[number] != 1:
            given = "is given twice" if numbers[number] else f"of {count} is not given"
            found.append(f"sortie {number} {given}")
    where: dict[int, list[int]] = {}
    for plan in plans:
        for waypoint in plan.waypoints:
            if waypoint.photo:
                where.setdefault(waypoint.id, []).append(plan.sortie.number)
    for waypoint_id, sorties in sorted(where.items()):
        if len(sorties) > 1:
            among = ", ".join(map(str, sorties))
            found.append(f"waypoint {waypoint_id} is in sorties {among}")
    return tuple(found)
