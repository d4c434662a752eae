"""Plans on disk: JSON that others can read, the same bytes for the same plan."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from jfto_msgs_py.files import read_text, write_file
from jfto_msgs_py.plan_reader import PLAN, UAV_LIMITS, plan_of_text
from jfto_msgs_py.records.certificate import Certificate
from jfto_msgs_py.records.plan import PLAN_FORMAT, PLAN_VERSION, Plan, Route, Uav, Waypoint

# Micrometres and microseconds: finer than any of it can be known, coarse enough that the last
# digit of a sum does not depend on the machine.
DECIMALS = 6
_ORIGIN_DECIMALS = 9


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


def plan_text(plan: Plan) -> str:
    """JSON text of a plan: fixed order of keys, fixed rounding, one record per line."""
    origin = plan.origin
    document: dict[str, Any] = {
        "format": PLAN_FORMAT,
        "version": PLAN_VERSION,
        "scenario_hash": plan.scenario_hash,
        "seed": plan.seed,
        "origin": {
            "lat": _plain(origin.lat_deg, _ORIGIN_DECIMALS),
            "lon": _plain(origin.lon_deg, _ORIGIN_DECIMALS),
            "alt_m": _plain(origin.alt_m),
        },
        "radio": _plain(dataclasses.asdict(plan.radio)),
        "k_min": plan.k_min,
        "delta": plan.delta,
        "d_min_m": _plain(plan.d_min_m),
        "length_max_m": _plain(plan.length_max_m),
        "time_model": plan.time_model,
        "time_parameters": _plain(dict(plan.time_parameters)),
        "slots": {
            "count": plan.slots.count,
            "duration_s": _plain(plan.slots.duration_s, _ORIGIN_DECIMALS),
        },
        "waypoints": [_plain(dataclasses.asdict(waypoint)) for waypoint in plan.waypoints],
        "uavs": [
            _uav_object(uav, route) for uav, route in zip(plan.uavs, plan.routes, strict=True)
        ],
        "positions_m": _plain(plan.positions_m.tolist()),
        "trajectories": [_plain(trajectory) for trajectory in plan.trajectories],
        "certificate": None if plan.certificate is None else _certificate_object(plan.certificate),
    }
    return "{\n" + ",\n".join(_member(name, document[name]) for name in document) + "\n}\n"


def rounded_waypoint(waypoint: Waypoint) -> Waypoint:
    """The waypoint as a plan file will hold it, so that times computed from it stay true."""
    east, north, up = _plain(waypoint.position_m)
    return Waypoint(
        waypoint.id, (east, north, up), _plain(waypoint.yaw_deg), _plain(waypoint.pitch_deg)
    )


def rounded_record(value: Any) -> Any:
    """Numbers, lists and objects as a plan file will hold them."""
    return _plain(value)


def _plain(value: Any, decimals: int = DECIMALS) -> Any:
    """JSON value with floats rounded, tuples as lists, minus zero as zero, non-finite as null."""
    if isinstance(value, dict):
        return {name: _plain(entry, decimals) for name, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(entry, decimals) for entry in value]
    if isinstance(value, np.ndarray):
        return _plain(value.tolist(), decimals)
    if isinstance(value, np.generic):
        return _plain(value.item(), decimals)
    if isinstance(value, float):
        return round(value, decimals) + 0.0 if math.isfinite(value) else None
    return value


def _member(name: str, value: Any) -> str:
    if isinstance(value, list) and value:
        rows = ",\n".join(f"  {_compact(entry)}" for entry in value)
        return f'"{name}": [\n{rows}\n]'
    return f'"{name}": {_compact(value)}'


def _compact(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def _uav_object(uav: Uav, route: Route) -> dict[str, Any]:
    return {
        "id": uav.id,
        **{name: _plain(getattr(uav, name)) for name in UAV_LIMITS},
        "start_m": _plain(uav.start_m),
        "route": list(route.waypoint_ids),
        "arrival_s": _plain(route.arrival_s),
        "length_m": _plain(route.length_m),
    }


def _certificate_object(certificate: Certificate) -> dict[str, Any]:
    plain: dict[str, Any] = _plain(dataclasses.asdict(certificate))
    return plain
