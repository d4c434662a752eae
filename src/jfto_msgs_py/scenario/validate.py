"""From the values that a file and the command line give to a checked scenario."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

from jfto_msgs_py.errors import ScenarioError
from jfto_msgs_py.records.fields import Key
from jfto_msgs_py.scenario.scenario import KEYS, PARTS, RADIO_SHORTHANDS, Scenario
from jfto_msgs_py.scenario.shape_text import ShapeTextError, read_shape
from jfto_msgs_py.scenario.value import Given, check_value, nearest

Layer = Mapping[str, Given]

# The area where nobody gives one, east-west and north-south.
_RECTANGLE_M = (2000.0, 2000.0)
_ROS_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


def make_scenario(layers: Sequence[Layer]) -> Scenario:
    """Scenario from layers of dotted keys, a later layer winning over an earlier one.

    Parameters
    ----------
    layers
        Values by key, each with where it was given.

    Returns
    -------
    Scenario
        Resolved and validated.

    Raises
    ------
    ScenarioError
        Lists every problem, one sentence each: where, which key, which value, which range, and what
        to do.
    """
    problems: list[str] = []
    given: dict[str, Given] = {}
    for layer in layers:
        given.update(_expand(layer, problems))
    values: dict[str, Any] = {}
    for name, item in given.items():
        value, found = check_value(KEYS[name], item)
        problems += found
        if not found:
            values[name] = value
    _resolve_fleet(values, given, problems)
    _check_together(values, given, problems)
    if problems:
        raise ScenarioError(problems)
    return Scenario(
        **{
            prefix: part(
                **{
                    name.split(".", 1)[1]: value
                    for name, value in values.items()
                    if name.startswith(f"{prefix}.")
                }
            )
            for prefix, part in PARTS.items()
        }
    )


def _expand(layer: Layer, problems: list[str]) -> dict[str, Given]:
    """Known keys of a layer, short-hands replaced by what they stand for."""
    expanded: dict[str, Given] = {}
    for name, item in layer.items():
        if name in KEYS:
            expanded[name] = item
            continue
        if name in RADIO_SHORTHANDS:
            both = [target for target in RADIO_SHORTHANDS[name] if target in layer]
            if both:
                problems.append(f"{item.origin}: {name} sets {both[0]} too. Give one of them.")
            expanded.update(dict.fromkeys(RADIO_SHORTHANDS[name], item))
            continue
        guess = nearest(name, [*KEYS, *RADIO_SHORTHANDS])
        cure = f"Did you mean {guess}?" if guess else "docs/reference/scenario.md lists all keys."
        problems.append(f"{item.origin}: unknown key {name}. {cure}")
    return expanded


def _resolve_fleet(values: dict[str, Any], given: Layer, problems: list[str]) -> None:
    """Give every per-UAV key one entry per UAV, and every UAV a name."""
    count = _value(values, "fleet.count")
    for name, key in KEYS.items():
        if not key.per_uav or (name in given and name not in values):
            continue
        entries = _value(values, name)
        if name == "fleet.ids":
            entries = entries or tuple(f"uav{number}" for number in range(1, count + 1))
        elif len(entries) == 1:
            entries = entries * count
        if len(entries) != count:
            problems.append(_wrong_count(key, given[name].origin, len(entries), count))
        values[name] = entries
    if "fleet.ids" in given and "fleet.ids" in values:
        _check_ids(values["fleet.ids"], given["fleet.ids"].origin, problems)


def _wrong_count(key: Key, origin: str, found: int, count: int) -> str:
    one = "" if key.name == "fleet.ids" else "one for all or "
    return (
        f"{origin}: {key.name} has {found} entries, but fleet.count is {count}. "
        f"Give {one}one per UAV, or set fleet.count to {found}."
    )


def _check_ids(ids: tuple[str, ...], origin: str, problems: list[str]) -> None:
    for index, name in enumerate(ids):
        if not _ROS_NAME.fullmatch(name):
            problems.append(
                f"{origin}: fleet.ids[{index}] is {name!r}, must be a ROS name: a letter, then "
                "letters, digits and underscores."
            )
        if name in ids[:index]:
            problems.append(
                f"{origin}: fleet.ids[{index}] is {name!r}, which is UAV {ids.index(name)}'s name "
                "too. Give each UAV a name of its own."
            )


def _check_together(values: dict[str, Any], given: Layer, problems: list[str]) -> None:
    """Rules that concern several keys at once."""

    def complain(name: str, text: str, *others: str) -> None:
        origins = [given[key].origin for key in (name, *others) if key in given]
        problems.append(f"{origins[0] if origins else 'scenario'}: {name} {text}")

    count, k_min = _value(values, "fleet.count"), _value(values, "network.k_min")
    if k_min >= count:
        complain(
            "network.k_min",
            f"is {k_min}, but {count} UAV{'s' * (count > 1)} can have at most {count - 1} "
            f"neighbours. Set it to {count - 1}{' or less' * (count > 1)}, or fleet.count to "
            f"{k_min + 1} or more.",
            "fleet.count",
        )
    slots = _value(values, "mission.slot_count")
    for name in ("evaluation.n_dc", "evaluation.slot_shown"):
        if _value(values, name) > slots:
            # A default that a short mission cannot hold moves to its last slot.
            if name in given:
                complain(name, f"is {values[name]}, but mission.slot_count is {slots}. Lower it.")
            values[name] = slots
    _check_waypoint_source(values, complain)
    center = _value(values, "terrain.center_deg")
    if center and abs(center[0]) > 90:
        complain(
            "terrain.center_deg",
            f"has latitude {center[0]:g}, outside -90…90 deg. Give latitude before longitude.",
        )
    _resolve_area(values, complain)
    _check_fence(values, complain)
    _check_camera(values, complain)
    _check_photos(values, complain)
    _check_starts(values, complain)
    _check_stations(values, complain)
    _check_batteries(values, given, complain)


def _check_waypoint_source(values: dict[str, Any], complain: Any) -> None:
    """The file, and the home its heights count from, belong to source file and to no other."""
    source = _value(values, "waypoints.source")
    if source == "file":
        if not _value(values, "waypoints.file"):
            complain(
                "waypoints.file",
                "is empty, but waypoints.source is file. Name the file.",
                "waypoints.source",
            )
        return
    for key, what in (("file", "file"), ("home_deg", "home")):
        if _value(values, f"waypoints.{key}"):
            complain(
                f"waypoints.{key}",
                f"is given, but waypoints.source is {source}. Set it to file, or remove the "
                f"{what}.",
                "waypoints.source",
            )


def _resolve_area(values: dict[str, Any], complain: Any) -> None:
    """Check the polygon, and give a rectangle its size."""
    polygon = _value(values, "area.polygon_deg")
    if polygon and _value(values, "area.file"):
        complain("area.polygon_deg", "is given beside area.file. Remove one of them.", "area.file")
    if len(polygon) % 2 or 0 < len(polygon) < 6:
        complain(
            "area.polygon_deg",
            f"has {len(polygon)} numbers, needs latitude and longitude in turn of 3 corners or "
            "more. Add what is missing.",
        )
    elif any(abs(lat) > 90 for lat in polygon[::2]):
        lat = next(lat for lat in polygon[::2] if abs(lat) > 90)
        complain(
            "area.polygon_deg",
            f"has latitude {lat:g}, outside -90…90 deg. Give latitude before longitude.",
        )
    if not polygon and not _value(values, "area.file"):
        for name in ("layer", "buffer_m"):
            if _value(values, f"area.{name}"):
                complain(f"area.{name}", "needs area.file or area.polygon_deg. Give one.")
        if not _value(values, "terrain.size_m"):
            values["terrain.size_m"] = _RECTANGLE_M
    elif _value(values, "area.layer") and polygon:
        complain("area.layer", "needs area.file. Remove it.")


def _check_fence(values: dict[str, Any], complain: Any) -> None:
    for name in ("fence.keep_out", "fence.keep_in"):
        for index, text in enumerate(_value(values, name)):
            try:
                shape = read_shape(text)
            except ShapeTextError as error:
                complain(name, f"[{index}] {error}")
                continue
            if name == "fence.keep_in" and (shape.bottom_m, shape.top_m) != (None, None):
                complain(name, f"[{index}] has a height, but what is to be kept in has none.")
    if _value(values, "fence.layer") and not _value(values, "fence.file"):
        complain("fence.layer", "needs fence.file. Give it, or remove the layer.")


def _check_camera(values: dict[str, Any], complain: Any) -> None:
    if _value(values, "camera.footprint_m") and not _value(values, "coverage.distance_m"):
        complain("camera.footprint_m", "needs coverage.distance_m: the distance it holds for.")
    low, high = _value(values, "coverage.pitch_min_deg"), _value(values, "coverage.pitch_max_deg")
    if low > high:
        complain(
            "coverage.pitch_min_deg",
            f"is {low:g}, above coverage.pitch_max_deg, {high:g}. Exchange them.",
            "coverage.pitch_max_deg",
        )


def _check_photos(values: dict[str, Any], complain: Any) -> None:
    hold_s = _value(values, "trajectory.hold_s")
    if _value(values, "trajectory.mode") == "waypoints" and hold_s != int(hold_s):
        complain(
            "trajectory.hold_s",
            f"is {hold_s:g}, but missions keep whole seconds. Set it to {math.ceil(hold_s)}.",
        )


def _check_stations(values: dict[str, Any], complain: Any) -> None:
    name = "network.ground_stations_deg"
    places = _value(values, name)
    if len(places) % 2:
        complain(name, f"has {len(places)} numbers, needs latitude and longitude in turn.")
    elif any(abs(latitude) > 90 for latitude in places[::2]):
        complain(name, "has a latitude beyond 90 deg. Give latitude before longitude.")


def _check_starts(values: dict[str, Any], complain: Any) -> None:
    for name in ("starts.positions_m", "sorties.positions_m"):
        numbers = len(_value(values, name))
        if numbers % 2:
            complain(
                name, f"has {numbers} numbers, needs pairs of east and north. Add or remove one."
            )
    count, starts = _value(values, "fleet.count"), _value(values, "starts.count")
    if starts > count:
        if "starts.count" in values:
            complain(
                "starts.count",
                f"is {starts}, but there are {count} UAVs. Set it to {count} or less.",
            )
        values["starts.count"] = count


def _check_batteries(values: dict[str, Any], given: Layer, complain: Any) -> None:
    """Batteries need powers; a latest arrival that nobody gives follows from the battery."""
    names = ("battery_wh", "hover_power_w", "endurance_s", "t_max_s")
    fleet = [
        dict(zip(names, row, strict=True))
        for row in zip(*(_value(values, f"fleet.{name}") for name in names), strict=False)
    ]
    if any(one["battery_wh"] and not one["hover_power_w"] for one in fleet):
        complain(
            "fleet.battery_wh",
            "is given without fleet.hover_power_w. Give the power that a UAV takes to stand in "
            "the air.",
        )
    if "fleet.t_max_s" not in given:
        values["fleet.t_max_s"] = tuple(
            0.0 if one["battery_wh"] else one["t_max_s"] for one in fleet
        )
    elif any(not (one["t_max_s"] or one["battery_wh"] or one["endurance_s"]) for one in fleet):
        complain(
            "fleet.t_max_s",
            "is 0, which is as late as the battery allows, but fleet.battery_wh and "
            "fleet.endurance_s are not given. Give one of them, or the seconds.",
        )


def _value(values: Mapping[str, Any], name: str) -> Any:
    return values.get(name, KEYS[name].default)
