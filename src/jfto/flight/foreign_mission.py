"""Missions that another ground station made or edited, held to what ours are held to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from jfto_mavlink.errors import MissionError, MissionFileError
from jfto_mavlink.files.mission_of_document import mission_of_document
from jfto_mavlink.mission.build import VehicleMission, map_items
from jfto_mavlink.mission.fence import fence_from_items
from jfto_mavlink.mission.limits import SAMPLE_M, MissionLimits, check_limits
from jfto_mavlink.preflight.case import mission_path
from jfto_mavlink.preflight.fence import figure_rooms
from jfto_msgs_py.mission_file import MissionDocument, MissionTextError, read_document
from jfto_msgs_py.records.site import Fence
from jfto_msgs_py.types import Array
from jfto_planner.coverage import Places, Spot
from jfto_world.terrain import Dem

# MAV_CMD numbers (mavlink.io, common.xml): flown to, and among them those that are waypoints.
_TAKE_OFF, _RETURN = 22, 20
_FLOWN_TO, _WAYPOINTS = (16, 17, 18, 19, 31, 82), (16, 82)
Legs = Sequence[tuple[str, Array]]


def foreign_mission(
    path: Path, uav: str, limits: MissionLimits, dem: Dem | None, fence: Fence | None = None
) -> tuple[VehicleMission, tuple[str, ...]]:
    """The mission in a `.plan` or `.waypoints` file for one vehicle, checked; notes on it.

    Its heights, distances and count of items keep to `limits`, its legs stay within the fence that
    it brings and, where the terrain is known, above the ground by `limits.clearance_min_m` and out
    of the zones of `fence`, the scenario's. Raises MissionFileError, MissionError, WaypointError.
    """
    try:
        document = read_document(path)
    except MissionTextError as error:
        raise MissionFileError(302, str(error)) from None
    mission = mission_of_document(document, str(path))
    if not mission.items:
        raise MissionFileError(302, f"{path}: holds no mission. Save one with a take-off in it.")
    who, notes = f"{uav} ({path})", list(mission.notes)
    if dem is not None:
        # The ground itself is the floor then, as for our own missions.
        limits = replace(limits, height_min_m=-limits.height_max_m)
    check_limits(who, mission.items, limits)
    home = mission.items[0]
    stops = [k for k, item in enumerate(mission.items) if k and item.command in _WAYPOINTS]
    places = tuple((i.lat_deg, i.lon_deg, i.z) for i in (mission.items[k] for k in stops))
    found = VehicleMission(
        uav,
        mission,
        map_items(mission.items, stops),
        tuple(range(len(stops))),
        places,
        (),
        (home.lat_deg, home.lon_deg, home.z),
    )
    _check_fence(who, found)
    if dem is None:
        notes.append(f"{path}: the terrain is not known; its legs are not held against the ground")
    else:
        legs = _legs(document, Places(str(path), dem, notes, None, document))
        take_off_m = next(i.params[6] for i in document.items if i.command == _TAKE_OFF)
        _check_ground(who, legs, dem, min(limits.clearance_min_m, take_off_m))
        _check_zones(who, legs, fence or Fence())
        if any(item.command == _RETURN for item in document.items):
            notes.append(
                f"{path}: returns by RTL, at the vehicle's own RTL_ALT, which is not held against "
                "the ground here"
            )
    return found, tuple(notes)


def _check_fence(who: str, mission: VehicleMission) -> None:
    """Raise MissionError where legs leave the fence that comes with the mission."""
    lat, lon, _ = mission.home_deg_m
    level_m = mission_path(mission)[:, :2]
    for room_m, words in figure_rooms(fence_from_items(mission.mission.fence), level_m, (lat, lon)):
        if room_m <= 0:
            raise MissionError(
                301, f"{who}: the mission breaks its own fence: {words}. Move one of them."
            )


def _legs(document: MissionDocument, places: Places) -> list[tuple[str, Array]]:
    """What each item flies to, by its name, and the way there: points (N, 3) some metres apart."""
    here: Spot | None = None
    legs = []
    for item in document.items:
        if item.command == _TAKE_OFF:
            here = places.take_off(item)
        if item.command not in _FLOWN_TO or not any(item.params[4:6]):
            continue
        spot = places.spot(item)
        start = spot if here is None else here
        apart_m = np.linalg.norm(np.subtract(spot.position_m, start.position_m))
        steps = max(int(apart_m / SAMPLE_M), 1)
        line = [places.between(start, spot, k / steps).position_m for k in range(steps + 1)]
        legs.append((item.place, np.array(line)))
        here = spot
    return legs


def _check_ground(who: str, legs: Legs, dem: Dem, wanted_m: float) -> None:
    """Raise MissionError for the leg that comes nearest the ground, where that is too near."""
    worst_m, worst = np.inf, ""
    for place, line in legs:
        if not dem.contains(line[:, 0], line[:, 1]).all():
            raise MissionError(
                301,
                f"{who}: the leg to {place} leaves the terrain, so that nothing is known of "
                "the ground below it. Enlarge terrain.size_m, or leave --scenario out.",
            )
        clearance_m = float(np.min(line[:, 2] - dem.top_height(line[:, 0], line[:, 1])))
        if clearance_m < worst_m:
            worst_m, worst = clearance_m, place
    if worst_m < wanted_m:
        raise MissionError(
            301,
            f"{who}: the leg to {worst} passes {worst_m:.1f} m above the ground, at least "
            f"{wanted_m:g} m is wanted. Raise it, or take off higher.",
        )


def _check_zones(who: str, legs: Legs, fence: Fence) -> None:
    """Raise MissionError for the first leg that enters a zone, or comes nearer than the margin."""
    if not (fence.keep_out or fence.keep_in):
        return
    # Loaded here: shapely is for those who have a fence.
    from jfto_world.site.free_space import FreeSpace

    free = FreeSpace(fence)
    for place, line in legs:
        entered = np.flatnonzero(free.crossed(line[:-1], line[1:]))
        if entered.size:
            k = int(entered[0])
            names = [name for name in free.inside(line[[k, k + 1]]) if name]
            raise MissionError(
                301,
                f"{who}: the leg to {place} leads into {names[0] if names else 'a no-fly zone'} "
                f"of the scenario's fence, or within its margin of {fence.margin_m:g} m. Lead it "
                "round.",
            )
