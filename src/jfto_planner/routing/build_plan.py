"""From routes to the plan record: of a scenario's, or of routes that were found for arrays."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.plan_file import rounded_record
from jfto_msgs_py.records.fields import record_from
from jfto_msgs_py.records.plan import Line, Origin, Plan, Route, Slots, Uav, Vector, Waypoint
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.records.site import Fence, Polygon, Sortie
from jfto_msgs_py.records.topology import LITERAL
from jfto_msgs_py.types import Array
from jfto_msgs_py.units import dbm_to_w, w_to_dbm
from jfto_msgs_py.whole_numbers import whole_number
from jfto_planner.routing.problem import RoutingProblem
from jfto_planner.smoothing.trajectory import Trajectory
from jfto_world.mission.encoding import ITEMS_MAX
from jfto_world.mission.lines import trigger_lines
from jfto_world.motion import ConstantSpeed, MotionLimits, TimeModel, time_model_named
from jfto_world.motion.lines import along
from jfto_world.radio import make_channel

# Arrivals at pad and waypoints, and positions at given times.
_Flight = tuple[Array, Callable[[Array], Array]]
# Of a fleet whose radios' energy is not known.
ANY_ENERGY_J = 1e9


@dataclass(frozen=True)
class PlanTerms:
    """What a plan says whatever its routes are; lengths in m, ENU about `origin`.

    Members that `Plan` has too go into it as they are. Slots divide `horizon_s`, or the makespan
    where it is None, into `slot_count`.
    """

    scenario_hash: str
    seed: int
    origin: Origin
    radio: Radio
    k_min: int
    delta: int
    d_min_m: float
    length_max_m: float
    slot_count: int
    horizon_s: float | None
    waypoints: tuple[Waypoint, ...]
    uavs: tuple[Uav, ...]
    wind_mps: float = 0.0
    topology: str = LITERAL
    area: tuple[Polygon, ...] = ()
    fence: Fence | None = None
    sortie: Sortie = field(default_factory=Sortie)
    trigger: str = "each"
    mission_items: int = ITEMS_MAX


def build_plan(
    routes: Sequence[Sequence[int]],
    terms: PlanTerms,
    time_model: str = "constant_speed",
    time_parameters: Mapping[str, float] | None = None,
    trajectories: Sequence[Trajectory] = (),
) -> Plan:
    """Plan of routes given as indices into the waypoints of `terms`.

    Lengths are those of straight legs.

    Parameters
    ----------
    routes
        One per UAV.
    terms
        What the plan says whatever its routes are.
    time_model
        Name of the model that arrivals and positions follow from.
    time_parameters
        Of that model; None for its defaults.
    trajectories
        One per UAV; where given, arrivals and positions follow from them.

    Returns
    -------
    Plan
        Without a certificate.

    Raises
    ------
    InputError
        The time model is unknown.
    """
    waypoints, uavs = terms.waypoints, terms.uavs
    records = tuple(rounded_record(trajectory.as_record()) for trajectory in trajectories)
    parameters: dict[str, float] = rounded_record(dict(time_parameters or {}))
    lines = []
    for uav, route in zip(uavs, routes, strict=True):
        points = [uav.start_m, *(waypoints[index].position_m for index in route)]
        lines.append(np.array(points, dtype=np.float64))
    rows: list[tuple[Line, ...]] = [()] * len(uavs)
    if records:
        flights = [_on_curve(Trajectory.from_record(record)) for record in records]
    else:
        model = time_model_named(time_model, parameters)
        # Who stops for every photograph is told of every waypoint.
        if not parameters.get("hold_s"):
            rows = _rows_of(routes, terms, model, lines)
        flights = [
            _by_model(along(model, row), line, uav)
            for row, line, uav in zip(rows, lines, uavs, strict=True)
        ]
    horizon_s = terms.horizon_s
    if horizon_s is None:
        horizon_s = max(float(arrival[-1]) for arrival, _ in flights)
    slots = Slots(terms.slot_count, horizon_s / terms.slot_count)
    return record_from(
        terms,
        Plan,
        slots=slots,
        routes=tuple(
            Route(
                waypoint_ids=tuple(waypoints[index].id for index in route),
                arrival_s=tuple(float(time) for time in arrival[1:]),
                length_m=float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum()),
                lines=row,
            )
            for route, line, row, (arrival, _) in zip(routes, lines, rows, flights, strict=True)
        ),
        positions_m=np.stack([position(slots.times_s) for _, position in flights]),
        time_model=time_model,
        time_parameters=parameters,
        trajectories=records,
    )


def _rows_of(
    routes: Sequence[Sequence[int]], terms: PlanTerms, model: TimeModel, lines: Sequence[Array]
) -> list[tuple[Line, ...]]:
    """Lines of each route on which one order takes all photographs."""
    found = []
    for uav, route, line in zip(terms.uavs, routes, lines, strict=True):
        on_route = [terms.waypoints[index] for index in route]

        def flown(rows: tuple[Line, ...], line: Array = line, uav: Uav = uav) -> Array:
            return _by_model(along(model, rows), line, uav)[0][1:]

        found.append(trigger_lines(on_route, terms.trigger, uav.speed_mps, flown))
    return found


def with_passed(
    waypoints: tuple[Waypoint, ...], problem: RoutingProblem, routes: Sequence[Sequence[int]]
) -> tuple[tuple[Waypoint, ...], tuple[tuple[int, ...], ...]]:
    """Waypoints and routes with the points that detours pass, one waypoint for each passage.

    Parameters
    ----------
    waypoints
        Those of the problem, in its order.
    problem
        Whose detours are flown.
    routes
        Indices of waypoints, one sequence per UAV.

    Returns
    -------
    tuple
        The waypoints, those without photo behind the others, looking as the next with one does;
        and the routes by their indices.
    """
    detours = problem.detours
    if detours is None:
        return waypoints, tuple(map(tuple, routes))
    found, longer = list(waypoints), []
    number = max(waypoint.id for waypoint in waypoints)
    for uav, route in enumerate(routes):
        stops: list[int] = []
        for here, there in problem.legs_of(uav, route):
            for point in detours.between(here, there):
                number += 1
                goal = waypoints[there]
                found.append(replace(goal, id=number, position_m=_vector(point), photo=False))
                stops.append(len(found) - 1)
            stops.append(there)
        longer.append(tuple(stops))
    return tuple(found), tuple(longer)


def _on_curve(trajectory: Trajectory) -> _Flight:
    return np.concatenate([[0.0], trajectory.waypoint_s[1:]]), trajectory.positions


def _by_model(model: TimeModel, line: Array, uav: Uav) -> _Flight:
    limits = MotionLimits(uav.speed_mps, uav.climb_mps, uav.descent_mps)
    return model.arrivals(line, limits), lambda times_s: model.positions(line, limits, times_s)


def plan_of(
    problem: RoutingProblem,
    routes: Sequence[Sequence[int]],
    *,
    radio: Radio | None = None,
    delta: int = 2,
    seed: int = 0,
    origin: Origin | None = None,
) -> Plan:
    """Plan record of routes for a problem, not yet checked: hand it to `certify`.

    UAVs are named uav1, uav2 …; their greatest powers are those that reach as far as the problem
    says.

    Parameters
    ----------
    problem
        What the routes solve.
    routes
        Indices of waypoints in order, one sequence per UAV, as in `SearchResult.routes`.
    radio
        Frequency, gains, sensitivity, bandwidth and noise; None for those of a scenario's defaults.
    delta
        Neighbours beyond K_min that the topology allows, δ.
    seed
        Of the search, for the record.
    origin
        Where the local frame sits; None for 0° N, 0° E, 0 m.

    Returns
    -------
    Plan
        With times and positions by the problem's time model.

    Raises
    ------
    InputError
        If routes are not one per UAV of indices 0 to W - 1, or the time model is one that a plan
        cannot name.
    """
    routes = _indices(problem, routes)
    radio = radio or Radio()
    terms = PlanTerms(
        scenario_hash="",
        seed=seed,
        origin=origin or Origin(0.0, 0.0, 0.0),
        radio=radio,
        k_min=problem.k_min,
        delta=delta,
        d_min_m=problem.d_min_m,
        length_max_m=problem.length_max_m,
        slot_count=problem.slot_count,
        horizon_s=problem.horizon_s,
        waypoints=tuple(Waypoint(k, _vector(p)) for k, p in enumerate(problem.waypoints_m)),
        uavs=_uavs(problem, radio),
    )
    return build_plan(routes, terms, *_named(problem.time_model))


def _uavs(problem: RoutingProblem, radio: Radio) -> tuple[Uav, ...]:
    sensitivity_w = float(dbm_to_w(radio.sensitivity_dbm))
    p_max_dbm = w_to_dbm(make_channel(radio).required_power(problem.reach_m, sensitivity_w))
    energy = problem.energy_j
    return tuple(
        Uav(
            id=f"uav{a + 1}",
            p_max_dbm=float(p_max_dbm[a]),
            energy_j=ANY_ENERGY_J if energy is None else float(energy[a]),
            t_max_s=float(problem.t_max_s[a]),
            speed_mps=limits.speed_mps,
            climb_mps=limits.climb_mps,
            descent_mps=limits.descent_mps,
            start_m=_vector(problem.starts_m[a]),
        )
        for a, limits in enumerate(problem.limits)
    )


def _indices(
    problem: RoutingProblem, routes: Sequence[Sequence[int]]
) -> tuple[tuple[int, ...], ...]:
    """Routes as ints that exist: one that counts from the end would be another's waypoint."""
    if not isinstance(routes, Sequence | np.ndarray) or isinstance(routes, str):
        raise InputError(
            f"routes is {routes!r}; give one sequence of indices per UAV, as SearchResult.routes."
        )
    if len(routes) != problem.uav_count:
        raise InputError(
            f"routes has {len(routes)} entries for {problem.uav_count} UAVs; give one each."
        )
    checked = []
    for a, route in enumerate(routes):
        if not isinstance(route, Sequence | np.ndarray) or isinstance(route, str):
            raise InputError(f"routes[{a}] is {route!r}, must be a sequence of indices.")
        places = [whole_number(f"routes[{a}][{k}]", index) for k, index in enumerate(route)]
        for k, index in enumerate(places):
            if not 0 <= index < problem.waypoint_count:
                raise InputError(
                    f"routes[{a}][{k}] is {index}, must be from 0 to {problem.waypoint_count - 1}."
                )
        checked.append(tuple(places))
    return tuple(checked)


def _named(model: TimeModel) -> tuple[str, Mapping[str, float]]:
    """Name and parameters of a time model in a plan."""
    if isinstance(model, ConstantSpeed):
        return "constant_speed", {}
    parameters = getattr(model, "parameters", None)
    if parameters is None:
        raise InputError(
            f"time_model is {type(model).__name__}, which a plan cannot name. Use ConstantSpeed or "
            "ArduCopter."
        )
    return "arducopter", parameters()


def _vector(point: Array) -> Vector:
    return float(point[0]), float(point[1]), float(point[2])
