"""Plans on disk: JSON that others can read, the same bytes for the same plan, read strictly."""

from __future__ import annotations

import hashlib
import itertools
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from jfto_msgs_py.errors import PlanError
from jfto_msgs_py.files import FileKind, plain, read_text, record_of_text, write_file
from jfto_msgs_py.records.battery import Battery
from jfto_msgs_py.records.certificate import Certificate
from jfto_msgs_py.records.fields import FILLED, MAY_LACK, OneOf, Range, record_from
from jfto_msgs_py.records.plan import (
    PLAN_FORMAT,
    PLAN_VERSION,
    PLAN_VERSIONS_READ,
    Line,
    Origin,
    Plan,
    Route,
    Slots,
    Uav,
    Vector,
    Waypoint,
)
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.records.site import Fence, GroundStation, Polygon, Sortie
from jfto_msgs_py.records.topology import LITERAL, TOPOLOGY_FORMS
from jfto_msgs_py.records.way_home import WayHome

PLAN = FileKind(
    "plan",
    "Write the plan anew with jfto plan SCENARIO.",
    denial="is not a plan",
    format=PLAN_FORMAT,
    version=PLAN_VERSION,
    versions_read=PLAN_VERSIONS_READ,
    size_limit=500_000_000,
    error=PlanError,
)
UAV_LIMITS = ("p_max_dbm", "energy_j", "t_max_s", "speed_mps", "climb_mps", "descent_mps")

# Micrometres and microseconds: finer than any of it can be known, coarse enough that the last
# digit of a sum does not depend on the machine.
DECIMALS = 6
_FINER_DECIMALS = 9


def write_plan(plan: Plan, path: str | Path) -> None:
    """Write a plan; raises InputError where the file cannot be written."""
    write_file(Path(path), plan_text(plan))


def read_plan(path: str | Path) -> Plan:
    """Plan of a file; raises PlanError that names the file, the key and what to do."""
    path = Path(path)
    return plan_of_text(read_text(path, PLAN.error, PLAN.what, PLAN.size_limit), path)


def rounded(plan: Plan) -> Plan:
    """The plan exactly as it will be read back; certify this one, not what the search held."""
    return plan_of_text(plan_text(plan), Path("plan"))


def plan_tag(plan: Plan) -> str:
    """What tells a plan from any other in a few characters; the same on every computer."""
    return text_digest(plan_text(plan))[:16]


def text_digest(text: str) -> str:
    """SHA-256 of a plan's text, as hexadecimal digits."""
    return hashlib.sha256(text.encode()).hexdigest()


def plan_text(plan: Plan) -> str:
    """JSON text of a plan: fixed order of keys, fixed rounding, one record per line."""
    origin, slots = plan.origin, plan.slots
    homes = plan.homes or (None,) * len(plan.uavs)
    document: dict[str, Any] = {
        "format": PLAN_FORMAT,
        "version": PLAN_VERSION,
        "scenario_hash": plan.scenario_hash,
        "seed": plan.seed,
        "origin": {"lat": origin.lat_deg, "lon": origin.lon_deg, "alt_m": origin.alt_m},
        "radio": plan.radio,
        "wind_mps": plan.wind_mps,
        "k_min": plan.k_min,
        "delta": plan.delta,
        "topology": plan.topology,
        "d_min_m": plan.d_min_m,
        "length_max_m": plan.length_max_m,
        "time_model": plan.time_model,
        "time_parameters": plan.time_parameters,
        "sortie": plan.sortie,
        "area": plan.area,
        "fence": plan.fence,
        "ground_stations": plan.ground_stations,
        "trigger": plan.trigger,
        "mission_items": plan.mission_items,
        "slots": {"count": slots.count, "duration_s": slots.duration_s},
        "waypoints": plan.waypoints,
        "uavs": [
            _uav_object(uav, route, home)
            for uav, route, home in zip(plan.uavs, plan.routes, homes, strict=True)
        ],
        "positions_m": plan.positions_m,
        "trajectories": plan.trajectories,
        "certificate": plan.certificate,
    }
    document = rounded_record(document)
    # A degree is a hundred kilometres long, and slots add up.
    if origin.datum:
        document["origin"]["datum"] = origin.datum
    degrees = {"lat": origin.lat_deg, "lon": origin.lon_deg}
    document["origin"] |= plain(degrees, _FINER_DECIMALS)
    document["slots"]["duration_s"] = plain(slots.duration_s, _FINER_DECIMALS)
    return "{\n" + ",\n".join(_member(name, document[name]) for name in document) + "\n}\n"


def rounded_waypoint(waypoint: Waypoint) -> Waypoint:
    """The waypoint as a plan file will hold it, so that times computed from it stay true."""
    yaw_deg, pitch_deg = rounded_record((waypoint.yaw_deg, waypoint.pitch_deg))
    position_m = tuple(rounded_record(waypoint.position_m))
    return replace(waypoint, position_m=position_m, yaw_deg=yaw_deg, pitch_deg=pitch_deg)


def rounded_record(value: Any) -> Any:
    """Numbers, lists, objects and records as a plan file will hold them."""
    return plain(value, DECIMALS)


def _member(name: str, value: Any) -> str:
    if isinstance(value, list) and value:
        rows = ",\n".join(f"  {_compact(entry)}" for entry in value)
        return f'"{name}": [\n{rows}\n]'
    return f'"{name}": {_compact(value)}'


def _compact(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def _uav_object(uav: Uav, route: Route, home: WayHome | None) -> dict[str, Any]:
    return {
        "id": uav.id,
        **{name: getattr(uav, name) for name in (*UAV_LIMITS, "endurance_s")},
        **({"battery": uav.battery} if uav.battery else {}),
        "start_m": uav.start_m,
        "route": route.waypoint_ids,
        "arrival_s": route.arrival_s,
        "length_m": route.length_m,
        "lines": route.lines,
        "home": home,
    }


Text = Annotated[str, FILLED]
Positive = Annotated[float, Range(0.0, above=True)]
NotNegative = Annotated[float, Range(0.0)]
Count = Annotated[int, Range(0)]


@dataclass(frozen=True)
class _Origin:
    lat: Annotated[float, Range(-90, 90)]
    lon: Annotated[float, Range(-180, 180)]
    alt_m: float
    datum: Text = field(default="", metadata=MAY_LACK)


@dataclass(frozen=True)
class _Uav:
    """A UAV and its route, which are one object in the file."""

    id: Text
    p_max_dbm: float
    energy_j: Positive
    t_max_s: Positive
    speed_mps: Positive
    climb_mps: Positive
    descent_mps: Positive
    start_m: Vector
    route: tuple[Count, ...]
    arrival_s: tuple[NotNegative, ...]
    length_m: NotNegative
    lines: tuple[Line, ...] = field(default=(), metadata=MAY_LACK)
    endurance_s: NotNegative = field(default=0.0, metadata=MAY_LACK)
    battery: Battery | None = field(default=None, metadata=MAY_LACK)
    home: WayHome | None = field(default=None, metadata=MAY_LACK)


@dataclass(frozen=True)
class _Document:
    """The members of a plan file.

    Plans at constant speed, the first, had no time_parameters; those of version 1 no wind_mps, and
    those of version 2 nothing of the site and of the form of C-TOP.
    """

    scenario_hash: Text
    seed: Count
    origin: _Origin
    radio: Radio
    k_min: Count
    delta: Count
    d_min_m: NotNegative
    length_max_m: NotNegative
    time_model: Text
    slots: Slots
    waypoints: tuple[Waypoint, ...]
    uavs: tuple[_Uav, ...]
    positions_m: tuple[tuple[Vector, ...], ...]
    trajectories: tuple[Mapping[str, Any], ...]
    certificate: Certificate | None
    time_parameters: Mapping[str, float] = field(default_factory=dict, metadata=MAY_LACK)
    wind_mps: NotNegative = field(default=0.0, metadata=MAY_LACK)
    topology: Annotated[str, OneOf(TOPOLOGY_FORMS)] = field(default=LITERAL, metadata=MAY_LACK)
    area: tuple[Polygon, ...] = field(default=(), metadata=MAY_LACK)
    fence: Fence | None = field(default=None, metadata=MAY_LACK)
    ground_stations: tuple[GroundStation, ...] = field(default=(), metadata=MAY_LACK)
    sortie: Sortie = field(default=Sortie(), metadata=MAY_LACK)
    trigger: Text = field(default="each", metadata=MAY_LACK)
    mission_items: Annotated[int, Range(1)] = field(default=650, metadata=MAY_LACK)


def plan_of_text(text: str, path: Path) -> Plan:
    """Plan of a JSON text; `path` names it in errors. Raises PlanError."""
    document = record_of_text(text, str(path), _Document, PLAN)
    fault = next(_faults(document), None)
    if fault is not None:
        raise PlanError(f"{path}: {fault}")
    uavs, origin = document.uavs, document.origin
    return record_from(
        document,
        Plan,
        origin=Origin(origin.lat, origin.lon, origin.alt_m, origin.datum),
        uavs=tuple(record_from(uav, Uav) for uav in uavs),
        routes=tuple(record_from(uav, Route, waypoint_ids=uav.route) for uav in uavs),
        homes=tuple(uav.home for uav in uavs if uav.home is not None),
        positions_m=np.array(document.positions_m, dtype=np.float64),
        trajectories=tuple(map(dict, document.trajectories)),
    )


def _faults(document: _Document) -> Iterator[str]:
    """What members that are right by themselves contradict in one another."""
    uavs, known = document.uavs, {waypoint.id for waypoint in document.waypoints}
    if not uavs:
        yield "uavs is empty. A plan needs at least one UAV."
    if document.k_min >= len(uavs):
        yield (
            f"k_min is {document.k_min}, but {len(uavs)} UAVs can have at most {len(uavs) - 1} "
            "neighbours. Correct one of them."
        )
    yield from _doubled("waypoints", [waypoint.id for waypoint in document.waypoints])
    yield from _doubled("uavs", [uav.id for uav in uavs])
    for index, uav in enumerate(uavs):
        yield from _route_faults(f"uavs[{index}]", uav, known)
        if (uav.home is None) != (uavs[0].home is None):
            yield f"uavs[{index}].home: either all UAVs have a way home or none. {PLAN.cure}"
        if uav.home is not None:
            yield from _home_faults(f"uavs[{index}].home", uav.home)
    yield from _wrong_count("positions_m", document.positions_m, len(uavs))
    for index, positions in enumerate(document.positions_m):
        yield from _wrong_count(f"positions_m[{index}]", positions, document.slots.count + 1)
    yield from _site_faults(document)
    floors = () if document.certificate is None else document.certificate.energy_floor_j
    if floors:
        yield from _wrong_count("certificate.energy_floor_j", floors, len(uavs))


def _site_faults(document: _Document) -> Iterator[str]:
    if document.sortie.number > document.sortie.count:
        number, count = document.sortie.number, document.sortie.count
        yield f"sortie.number is {number} of {count}. Correct one of them."
    fence = document.fence or Fence()
    rings = [(f"area[{k}]", part) for k, part in enumerate(document.area)]
    rings += [(f"fence.keep_in[{k}]", part) for k, part in enumerate(fence.keep_in)]
    for where, part in rings:
        for ring in (part.outer, *part.holes):
            if len(ring) < 3:
                yield f"{where} has a ring of {len(ring)} corners, needs 3. {PLAN.cure}"
    for index, zone in enumerate(fence.keep_out):
        where = f"fence.keep_out[{index}] ({zone.name})"
        if (len(zone.outer) >= 3) == (zone.radius_m > 0) or 0 < len(zone.outer) < 3:
            yield f"{where} must be either a ring of 3 corners or more or a circle. {PLAN.cure}"
        low, high = zone.bottom_m, zone.top_m
        if low is not None and high is not None and low >= high:
            yield f"{where}: bottom_m is not below top_m. Exchange them."


def _route_faults(where: str, uav: _Uav, known: set[int]) -> Iterator[str]:
    for index, waypoint in enumerate(uav.route):
        if waypoint not in known:
            yield (
                f"{where}.route[{index}] is {waypoint}, but waypoints has no such id. Correct the "
                "route."
            )
    times = uav.arrival_s
    if len(times) != len(uav.route):
        yield (
            f"{where}.arrival_s has {len(times)} times for {len(uav.route)} waypoints. Give one "
            "per waypoint."
        )
    if any(later < earlier for earlier, later in itertools.pairwise(times)):
        yield f"{where}.arrival_s runs backwards. Times must not decrease."
    end = -1
    for index, line in enumerate(uav.lines):
        if not end < line.first < line.last < len(uav.route):
            yield (
                f"{where}.lines[{index}] is {line.first} to {line.last}, must come after the line "
                f"before it and end on the route. {PLAN.cure}"
            )
        end = line.last


def _home_faults(where: str, home: WayHome) -> Iterator[str]:
    if not home.points_m:
        yield f"{where}.points_m is empty. {PLAN.cure}"
    yield from _wrong_count(f"{where}.reached_s", home.reached_s, len(home.points_m))
    times = (*home.reached_s, home.landed_s)
    if any(later < earlier for earlier, later in itertools.pairwise(times)):
        yield f"{where}: its times run backwards. They must not decrease."


def _doubled(where: str, ids: Sequence[int | str]) -> Iterator[str]:
    first = {name: index for index, name in reversed(list(enumerate(ids)))}
    for index, name in enumerate(ids):
        if first[name] != index:
            yield f"{where}[{index}].id is {name!r} a second time. Ids must differ."


def _wrong_count(where: str, entries: Sequence[Any], count: int) -> Iterator[str]:
    if len(entries) != count:
        yield f"{where} has {len(entries)} entries, needs {count}. {PLAN.cure}"
