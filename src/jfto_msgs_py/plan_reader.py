"""Reading a plan, strictly: whatever does not fit is said with its place and its cure."""

from __future__ import annotations

import dataclasses
import itertools
import math
from pathlib import Path
from typing import Any

from jfto_msgs_py.certificate import KINDS, Certificate, Violation
from jfto_msgs_py.errors import InputError, PlanError
from jfto_msgs_py.json_node import JsonNode, parse_json
from jfto_msgs_py.plan import PLAN_FORMAT, PLAN_VERSION, Origin, Plan, Route, Slots, Uav, Waypoint
from jfto_msgs_py.radio import Radio

TOP_KEYS = (
    "format",
    "version",
    "scenario_hash",
    "seed",
    "origin",
    "radio",
    "k_min",
    "delta",
    "d_min_m",
    "length_max_m",
    "time_model",
    "slots",
    "waypoints",
    "uavs",
    "positions_m",
    "trajectories",
    "certificate",
)
UAV_LIMITS = ("p_max_dbm", "energy_j", "t_max_s", "speed_mps", "climb_mps", "descent_mps")
# Plans at constant speed, the first there were, had no parameters.
_OPTIONAL_KEYS = ("time_parameters",)
_UAV_KEYS = ("id", *UAV_LIMITS, "start_m", "route", "arrival_s", "length_m")


def plan_of_text(text: str, path: Path) -> Plan:
    """Plan of a JSON text; `path` names it in errors. Raises PlanError."""
    root = parse_json(text, path)
    _check_format(root)
    top = root.keys(TOP_KEYS, _OPTIONAL_KEYS)
    slots = _slots(top["slots"])
    waypoints = _waypoints(top["waypoints"])
    known = {waypoint.id for waypoint in waypoints}
    uav_nodes = top["uavs"].items()
    if not uav_nodes:
        raise top["uavs"].error("is empty. A plan needs at least one UAV.")
    members = [node.keys(_UAV_KEYS) for node in uav_nodes]
    uavs = tuple(_uav(member) for member in members)
    _check_unique(top["uavs"], [uav.id for uav in uavs])
    return Plan(
        scenario_hash=top["scenario_hash"].text(),
        seed=top["seed"].integer(0),
        origin=_origin(top["origin"]),
        radio=_radio(top["radio"]),
        k_min=_k_min(top["k_min"], len(uavs)),
        delta=top["delta"].integer(0),
        d_min_m=top["d_min_m"].number(0.0),
        length_max_m=top["length_max_m"].number(0.0),
        slots=slots,
        waypoints=waypoints,
        uavs=uavs,
        routes=tuple(_route(member, known) for member in members),
        positions_m=top["positions_m"].array((len(uavs), slots.count + 1, 3)),
        certificate=_certificate(top["certificate"], len(uavs)),
        time_model=top["time_model"].text(),
        time_parameters=_numbers(top.get("time_parameters")),
        trajectories=tuple(_trajectory(node) for node in top["trajectories"].items()),
    )


def _check_format(root: JsonNode) -> None:
    if not isinstance(root.value, dict) or root.value.get("format") != PLAN_FORMAT:
        raise PlanError(
            f'{root.file}: is not a plan: its key format is not "{PLAN_FORMAT}". '
            "Write one with jfto plan SCENARIO."
        )
    version = root.value.get("version")
    if version != PLAN_VERSION or isinstance(version, bool):
        raise PlanError(
            f"{root.file}: version is {version!r}, this program reads {PLAN_VERSION}. "
            "Write the plan anew with jfto plan, or use the program that wrote it."
        )


def _origin(node: JsonNode) -> Origin:
    member = node.keys(("lat", "lon", "alt_m"))
    return Origin(
        member["lat"].number(-90, 90), member["lon"].number(-180, 180), member["alt_m"].number()
    )


def _radio(node: JsonNode) -> Radio:
    fields = dataclasses.fields(Radio)
    member = node.keys([field.name for field in fields])
    values: dict[str, Any] = {
        field.name: member[field.name].text()
        if isinstance(field.default, str)
        else member[field.name].number()
        for field in fields
    }
    try:
        return Radio(**values)
    except InputError as error:
        raise PlanError(f"{node.file}: {error}") from None


def _slots(node: JsonNode) -> Slots:
    member = node.keys(("count", "duration_s"))
    slots = Slots(member["count"].integer(1), member["duration_s"].number(0.0))
    if slots.duration_s == 0:
        raise member["duration_s"].error("is 0, must be positive.")
    return slots


def _waypoints(node: JsonNode) -> tuple[Waypoint, ...]:
    waypoints = []
    for entry in node.items():
        member = entry.keys(("id", "position_m", "yaw_deg", "pitch_deg"))
        waypoints.append(
            Waypoint(
                member["id"].integer(0),
                member["position_m"].vector(),
                member["yaw_deg"].number(),
                member["pitch_deg"].number(-90, 90),
            )
        )
    _check_unique(node, [waypoint.id for waypoint in waypoints])
    return tuple(waypoints)


def _check_unique(node: JsonNode, ids: list[Any]) -> None:
    seen = set()
    for index, name in enumerate(ids):
        if name in seen:
            raise PlanError(
                f"{node.file}: {node.where}[{index}].id is {name!r} a second time. Ids must differ."
            )
        seen.add(name)


def _uav(member: dict[str, JsonNode]) -> Uav:
    limits = {name: member[name].number() for name in UAV_LIMITS}
    for name, value in limits.items():
        if name != "p_max_dbm" and value <= 0:
            raise member[name].error(f"is {value:g}, must be positive.")
    return Uav(id=member["id"].text(), start_m=member["start_m"].vector(), **limits)


def _route(member: dict[str, JsonNode], known: set[int]) -> Route:
    ids = []
    for node in member["route"].items():
        ids.append(node.integer(0))
        if ids[-1] not in known:
            raise node.error(f"is {ids[-1]}, but waypoints has no such id. Correct the route.")
    arrival = [node.number(0.0) for node in member["arrival_s"].items()]
    if len(arrival) != len(ids):
        raise member["arrival_s"].error(
            f"has {len(arrival)} times for {len(ids)} waypoints. Give one per waypoint."
        )
    if any(later < earlier for earlier, later in itertools.pairwise(arrival)):
        raise member["arrival_s"].error("runs backwards. Times must not decrease.")
    return Route(tuple(ids), tuple(arrival), member["length_m"].number(0.0))


def _k_min(node: JsonNode, uav_count: int) -> int:
    k_min = node.integer(1)
    if k_min >= uav_count:
        raise node.error(
            f"is {k_min}, but {uav_count} UAVs can have at most {uav_count - 1} neighbours."
        )
    return k_min


def _numbers(node: JsonNode | None) -> dict[str, float]:
    if node is None:
        return {}
    if not isinstance(node.value, dict):
        raise node.error("must be an object of numbers.")
    return {name: member.number() for name, member in node.keys(node.value).items()}


def _trajectory(node: JsonNode) -> dict[str, Any]:
    if not isinstance(node.value, dict):
        raise node.error("must be an object.")
    return dict(node.value)


def _certificate(node: JsonNode, uav_count: int) -> Certificate | None:
    if node.value is None:
        return None
    member = node.keys([field.name for field in dataclasses.fields(Certificate)])
    energy = member["energy_floor_j"].items()
    if len(energy) not in {0, uav_count}:
        raise member["energy_floor_j"].error(f"has {len(energy)} entries, needs {uav_count}.")
    return Certificate(
        clean=member["clean"].flag(),
        slot_checks=member["slot_checks"].integer(0),
        slot_violations=member["slot_violations"].integer(0),
        fine_violations=member["fine_violations"].integer(0),
        worst_margin_db=_or_nan(member["worst_margin_db"]),
        worst_margin_uav=str(member["worst_margin_uav"].value),
        worst_margin_slot=_or_nan(member["worst_margin_slot"]),
        worst_separation_m=_or_nan(member["worst_separation_m"]),
        energy_floor_j=tuple(_or_nan(entry) for entry in energy),
        violations=tuple(_violation(entry) for entry in member["violations"].items()),
    )


def _violation(node: JsonNode) -> Violation:
    member = node.keys([field.name for field in dataclasses.fields(Violation)])
    kind = member["kind"].text()
    if kind not in KINDS:
        raise member["kind"].error(f"is {kind!r}, must be one of {', '.join(KINDS)}.")
    return Violation(
        kind=kind,
        uav=str(member["uav"].value),
        slot=member["slot"].number_or_none(),
        time_s=member["time_s"].number_or_none(),
        value=_or_nan(member["value"]),
        limit=_or_nan(member["limit"]),
        message=member["message"].text(),
    )


def _or_nan(node: JsonNode) -> float:
    number = node.number_or_none()
    return math.nan if number is None else number
