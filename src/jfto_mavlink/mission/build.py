"""Missions from a plan, in the one order of items that a real ArduCopter was measured to honour."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import MissionError
from jfto_mavlink.mission.fence import Fence, RallyPoint, fence_items, rally_items
from jfto_mavlink.mission.limits import (
    Ground,
    MissionLimits,
    check_clearance,
    check_limits,
    return_height_m,
)
from jfto_mavlink.mission.photo_items import PhotoItems
from jfto_mavlink.mission.plan_fence import FIGURES_ONLY, left_out, plan_fence
from jfto_mavlink.mission.settings import MissionSettings, check_as_planned
from jfto_mavlink.mission.stored import mission_hash
from jfto_mavlink.mission.way_home import home_items, landing_parameters, return_heights_m
from jfto_mavlink.protocol.item import FRAME_ABSOLUTE, FRAME_HOME, FRAME_NONE, Item, Mission, at
from jfto_msgs_py.records.plan import Plan, Route, Uav, Waypoint
from jfto_msgs_py.types import Array
from jfto_world.mission.steps import SPEEDS, Kind, route_steps
from jfto_world.motion import MotionLimits
from jfto_world.motion.arducopter import ArduCopter
from jfto_world.terrain.frame import LocalFrame

# Of a wanted 2 m, a radius of 2 m used 0.9 to 2.4 m in flights on slopes.
RADIUS_SHARE = 0.6
# Whoever follows a target needs a little more than the target does.
SPARE = 1.2
# Without it ArduCopter turns the nose along the route at every waypoint.
KEEPS_HEADING = ("WP_YAW_BEHAVIOR", 0.0)


@dataclass(frozen=True)
class VehicleMission:
    """One vehicle's mission and what is needed to follow it.

    `waypoints_deg_m` holds latitude, longitude and height above home of each route waypoint,
    `pad_m` the pad (ENU), `speeds_mps` the plan's level, climb and descent, `ends_s` when its way
    home begins and `landed_s` when it is planned to be down, 0 if it is not, s from lift-off.
    `left_out` names zones of the plan that the vehicle's fence is without, as they have heights.
    """

    uav: str
    mission: Mission
    item_map: ItemMap
    waypoint_ids: tuple[int, ...]
    waypoints_deg_m: tuple[tuple[float, float, float], ...]
    arrival_s: tuple[float, ...]
    home_deg_m: tuple[float, float, float]
    pad_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    speeds_mps: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ends_s: float = 0.0
    landed_s: float = 0.0
    left_out: tuple[str, ...] = ()

    @property
    def digest(self) -> str:
        """Hash over the stored form of the mission."""
        return mission_hash(self.mission)


def build_missions(
    plan: Plan,
    settings: MissionSettings,
    fence: Fence | None = None,
    rally: Sequence[RallyPoint] = (),
    fence_heights_m: tuple[float, float] | None = None,
    ground: Ground | None = None,
) -> tuple[VehicleMission, ...]:
    """One mission per UAV of the plan, in its order; raises MissionError.

    With `ground` (ENU heights of the terrain) legs must clear it by `limits.clearance_min_m`, which
    replaces the least height above home. The way home is the plan's, as waypoints; where it has
    none, or nobody is to wait for the others, it is RTL, high enough over the ground. Without
    `fence` vehicles get the plan's own, where it has one, switched on.
    """
    check_as_planned(plan, settings)
    own = plan_fence(plan) if fence is None else Fence()
    shared = Mission(fence=fence_items(fence or own), rally=rally_items(rally))
    by_id = {waypoint.id: waypoint for waypoint in plan.waypoints}
    missions = []
    returns = () if ground is None else return_heights_m(plan, ground, settings.limits)
    for index, (uav, route) in enumerate(zip(plan.uavs, plan.routes, strict=True)):
        unknown = [i for i in route.waypoint_ids if i not in by_id]
        if unknown:
            raise MissionError(303, f"{uav.id}: waypoint {unknown[0]} is not in the plan.")
        waypoints = [by_id[i] for i in route.waypoint_ids]
        parameters = _parameters(uav, plan, settings, fence_heights_m)
        if own != Fence():
            parameters += (("FENCE_TYPE", FIGURES_ONLY), ("FENCE_ENABLE", 1.0))
        if returns:
            parameters += (("RTL_ALT", 100.0 * returns[index]),)
        alike = replace(shared, parameters=parameters)
        built = _build_one(index, waypoints, plan, settings, ground, alike)
        landed_s = plan.homes[index].landed_s if plan.homes else 0.0
        missions.append(replace(built, landed_s=landed_s, left_out=left_out(plan)))
    return tuple(missions)


def _build_one(
    index: int,
    waypoints: Sequence[Waypoint],
    plan: Plan,
    settings: MissionSettings,
    ground: Ground | None,
    shared: Mission,
) -> VehicleMission:
    """The mission of a route, with all but its items from `shared`."""
    uav, route, frame = plan.uavs[index], plan.routes[index], LocalFrame(plan.origin)
    home = plan.homes[index] if plan.homes and settings.relay_until_end else None
    points = np.array([uav.start_m, *(w.position_m for w in waypoints)])
    if ground is not None:
        way = None if home is None else home.line_m[1:]
        settings = _over_ground(uav.id, points, way, settings, ground)
    lat, lon, alt = frame.to_geodetic(points)
    heights = alt - alt[0]
    places = [(float(a), float(o), float(h)) for a, o, h in zip(lat, lon, heights, strict=True)]
    home_alt_m = float(alt[0])
    items = [
        at(mavlink.MAV_CMD_NAV_WAYPOINT, FRAME_ABSOLUTE, *places[0][:2], home_alt_m),
        Item(mavlink.MAV_CMD_NAV_TAKEOFF, FRAME_HOME, z=settings.takeoff_height_m),
        *(_speed_items(uav) if settings.set_speeds else ()),
    ]
    _check_gates(uav.id, route, settings)
    written = route_steps(waypoints, route.arrival_s, route.lines, settings.encoding, plan.trigger)
    maker = PhotoItems(route, points[1:], places[1:], frame, home_alt_m, settings)
    flown_by = {
        step.waypoint: len(items) + n
        for n, step in enumerate(written.steps)
        if step.kind is Kind.GO
    }
    items += [maker.of(step) for step in written.steps]
    if written.keeps_heading:
        shared = replace(shared, parameters=(*shared.parameters, KEEPS_HEADING))
    last = places[-1] if waypoints else (*places[0][:2], settings.takeoff_height_m)
    if home is not None:
        streamed = _speed_items(uav) if plan.trajectories else ()
        items += home_items(home, frame, last, (*places[0][:2], home_alt_m), streamed)
    else:
        items += _ending_items(route, last, plan.slots.horizon_s, settings)
    check_limits(uav.id, items, _with_most(settings.limits, plan.mission_items))
    return VehicleMission(
        uav.id,
        replace(shared, items=tuple(items)),
        map_items(items, _by_item(flown_by, len(waypoints))),
        route.waypoint_ids,
        tuple(places[1:]),
        route.arrival_s,
        (places[0][0], places[0][1], home_alt_m),
        uav.start_m,
        (uav.speed_mps, uav.climb_mps, uav.descent_mps),
        max(route.end_s, plan.slots.horizon_s if settings.relay_until_end else 0.0),
    )


def _parameters(
    uav: Uav,
    plan: Plan,
    settings: MissionSettings,
    fence_heights_m: tuple[float, float] | None,
) -> tuple[tuple[str, float], ...]:
    """Settings of the autopilot: all that the plan's times rely on, and the fence's heights.

    Without times of a mission (another time model) only how far corners may be cut.
    """
    # The target passes a waypoint within this radius; the vehicle follows it a little more widely.
    radius_m = settings.pass_within_m * RADIUS_SHARE
    found = [("WPNAV_RADIUS", float(round(100 * radius_m)))]
    if plan.time_model == "arducopter":
        limits = MotionLimits(uav.speed_mps, uav.climb_mps, uav.descent_mps)
        wpnav = ArduCopter.of_parameters(plan.time_parameters).wpnav.within(limits)
        if wpnav.radius_m > radius_m + 0.005:
            raise MissionError(
                303,
                f"{uav.id}: its plan is timed with corners cut by {wpnav.radius_m:g} m, but "
                f"waypoints are to be passed within {settings.pass_within_m:g} m, which takes "
                f"{radius_m:g} m. Allow {wpnav.radius_m / RADIUS_SHARE:.3g} m, or plan anew with "
                f"trajectory.wpnav_radius_m {radius_m:g}.",
            )
        found = list(wpnav.as_parameters().items())
    elif plan.trajectories:
        # Streamed targets are followed no faster than these; their defaults are less than a curve.
        found += [
            ("WPNAV_SPEED_UP", float(round(100 * SPARE * uav.climb_mps))),
            ("WPNAV_SPEED_DN", float(round(100 * SPARE * uav.descent_mps))),
            ("WPNAV_ACCEL_Z", float(round(100 * SPARE * plan.time_parameters["accel_z_mps2"]))),
        ]
    if plan.homes:
        found += landing_parameters()
    if fence_heights_m is not None:
        found += [("FENCE_ALT_MIN", fence_heights_m[0]), ("FENCE_ALT_MAX", fence_heights_m[1])]
    return tuple(found)


def _over_ground(
    uav: str,
    points_m: Array,
    way_home_m: Array | None,
    settings: MissionSettings,
    ground: Ground,
) -> MissionSettings:
    """Settings whose return clears the ground, after the check that route and way home do."""
    limits = settings.limits
    path = points_m.copy() if way_home_m is None else np.concatenate([points_m, way_home_m])
    path[0, 2] += settings.takeoff_height_m
    check_clearance(uav, path, ground, min(limits.clearance_min_m, settings.takeoff_height_m))
    height = return_height_m(points_m[0], points_m[-1], ground, limits.return_clearance_m)
    return replace(
        settings,
        return_height_m=max(height, settings.return_height_m or height),
        limits=replace(limits, height_min_m=-limits.height_max_m),
    )


def _check_gates(uav: str, route: Route, settings: MissionSettings) -> None:
    for line in route.lines:
        inside = [gate for gate in settings.gates if line.first <= gate < line.last]
        if inside:
            raise MissionError(
                303,
                f"{uav}: its time gate behind waypoint {inside[0] + 1} lies on a line that is "
                f"photographed in one go, to waypoint {line.last + 1}. Put the gate there, or plan "
                "with coverage.trigger each.",
            )


def _by_item(flown_by: dict[int, int], count: int) -> list[int]:
    """Item with which each waypoint is passed: inside a line that of its end."""
    items: list[int] = []
    for k in reversed(range(count)):
        items.append(flown_by.get(k, items[-1] if items else 0))
    return items[::-1]


def _with_most(limits: MissionLimits, items: int) -> MissionLimits:
    return limits if limits.items_max else replace(limits, items_max=items)


def _speed_items(uav: Uav) -> list[Item]:
    return [
        Item(mavlink.MAV_CMD_DO_CHANGE_SPEED, FRAME_NONE, (kind, speed, -1.0, 0.0))
        for kind, speed in zip(SPEEDS, (uav.speed_mps, uav.climb_mps, uav.descent_mps), strict=True)
    ]


def _ending_items(
    route: Route,
    last: tuple[float, float, float],
    horizon_s: float,
    settings: MissionSettings,
) -> list[Item]:
    items = []
    lat, lon, height = last
    wait_s = horizon_s - (route.arrival_s[-1] if route.arrival_s else 0.0)
    if settings.relay_until_end and wait_s >= 1:
        items.append(
            at(mavlink.MAV_CMD_NAV_LOITER_TIME, FRAME_HOME, lat, lon, height, math.ceil(wait_s))
        )
    if settings.return_height_m is not None and settings.return_height_m > height:
        items.append(
            at(mavlink.MAV_CMD_NAV_WAYPOINT, FRAME_HOME, lat, lon, settings.return_height_m)
        )
    items.append(Item(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH, FRAME_NONE))
    return items


@dataclass(frozen=True)
class ItemMap:
    """`items[k]` is the item of the route's k-th waypoint, or the line's end that it lies before.

    `reached` has the waypoint for which each item stands when it is reached.
    """

    items: tuple[int, ...]
    reached: tuple[int | None, ...]

    def waypoint(self, reached_seq: int) -> int | None:
        """Index along the route of the waypoint that a reached item stands for, if any."""
        return self.reached[reached_seq] if 0 <= reached_seq < len(self.reached) else None

    def inside_line(self, index: int) -> bool:
        """Whether the vehicle is not told of a waypoint: it shares the item of the next one."""
        return 0 <= index < len(self.items) - 1 and self.items[index] == self.items[index + 1]

    def next_waypoint(self, current_seq: int) -> int | None:
        """Index of the first waypoint not yet reached while item `current_seq` is flown."""
        for index, seq in enumerate(self.items):
            if seq >= current_seq:
                return index
        return None


def map_items(items: Sequence[Item], waypoint_items: Sequence[int]) -> ItemMap:
    """Map of a mission whose route waypoints are the given items."""
    index_of = {seq: index for index, seq in enumerate(waypoint_items)}
    reached: list[int | None] = []
    current: int | None = None
    for seq, item in enumerate(items):
        if item.is_nav:
            current = index_of.get(seq)
        reached.append(current)
    return ItemMap(tuple(waypoint_items), tuple(reached))
