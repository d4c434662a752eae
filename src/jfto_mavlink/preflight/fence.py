"""The mission against the fence that the vehicle has on board, before the vehicle meets it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from jfto_mavlink.mission.fence import Fence, fence_from_items
from jfto_mavlink.preflight.case import Case, mission_path
from jfto_mavlink.preflight.page import AMBER, GREEN, RED, Finding
from jfto_mavlink.preflight.shapes import circle_room_m, polygon_room_m
from jfto_mavlink.protocol.item import offset_m
from jfto_msgs_py.types import Array

TOP, CIRCLE, FIGURES, FLOOR = 1, 2, 4, 8
ACTIONS = {
    0: "only reports it",
    1: "returns home",
    2: "lands where it is",
    3: "returns the way it came",
    4: "brakes",
    5: "returns the way it came or lands",
}


def fence(case: Case) -> Iterator[Finding]:
    """Whether every leg stays within the vehicle's fence, and by how much."""
    if case.aboard.unread:
        cure = "Look at the link, then check again"
        yield Finding("fence", RED, case.aboard.unread, f"{cure}.")
        return
    if zones := ", ".join(case.mission.left_out):
        yield Finding(
            "fence", GREEN, f"is without {zones}: zones with heights are only planned for"
        )
    if not case.value("FENCE_ENABLE"):
        yield Finding("fence", GREEN, "its fence is off")
        return
    rooms = tuple(_rooms(case))
    if not rooms:
        yield Finding("fence", AMBER, "its fence is on and holds nothing", "Set FENCE_TYPE.")
        return
    margin_m = case.value("FENCE_MARGIN", 2.0)
    action = int(case.value("FENCE_ACTION"))
    does = ACTIONS.get(action, f"acts as FENCE_ACTION {action} says")
    found = False
    for room_m, what, cure in rooms:
        if room_m <= 0:
            found = True
            level = RED if action else AMBER
            yield Finding("fence", level, f"the mission breaks its fence: {what}; it {does}", cure)
        elif room_m < margin_m:
            found = True
            text = f"the mission comes within {room_m:.1f} m of its fence (margin {margin_m:g} m)"
            yield Finding("fence", AMBER, f"{text}: {what}", cure)
    if not found:
        least = min(room for room, _, _ in rooms)
        yield Finding("fence", GREEN, f"stays {least:.0f} m inside its fence")


def _rooms(case: Case) -> Iterator[tuple[float, str, str]]:
    """Of each part of the fence: room in m, what is compared, and the cure where it is too little.

    As ArduCopter has it, ceiling, floor and circle are about home.
    """
    kinds, path, value = int(case.value("FENCE_TYPE")), case.path_m, case.value
    if kinds & TOP:
        high, limit = float(path[:, 2].max()), value("FENCE_ALT_MAX")
        cure = f"Raise FENCE_ALT_MAX above {high + value('FENCE_MARGIN', 2.0):.0f}, or plan lower."
        yield limit - high, f"it climbs to {high:.0f} m, FENCE_ALT_MAX is {limit:g} m", cure
    if kinds & FLOOR:
        # It counts once a vehicle has been above it: not on the climb from the pad.
        low, limit = float(mission_path(case.mission)[1:, 2].min()), value("FENCE_ALT_MIN")
        cure = f"Lower FENCE_ALT_MIN below {low - value('FENCE_MARGIN', 2.0):.0f}, or plan higher."
        yield low - limit, f"it flies down to {low:.0f} m, FENCE_ALT_MIN is {limit:g} m", cure
    if kinds & CIRCLE:
        far, limit = float(np.hypot(path[:, 0], path[:, 1]).max()), value("FENCE_RADIUS")
        cure = f"Raise FENCE_RADIUS above {far + value('FENCE_MARGIN', 2.0):.0f}, or plan nearer."
        yield limit - far, f"it flies {far:.0f} m from home, FENCE_RADIUS is {limit:g} m", cure
    if kinds & FIGURES:
        own = case.mission.mission.fence
        yield from _figures(case, fence_from_items(own) if own else case.aboard.fence)


def _figures(case: Case, figures: Fence) -> Iterator[tuple[float, str, str]]:
    """The same of the figures; a mission that brings its own is held against those."""
    cure = "Change the fence on board, or plan within it."
    lat, lon, _ = case.mission.home_deg_m
    for room, words in figure_rooms(figures, case.path_m[:, :2], (lat, lon)):
        yield room, words, cure


def figure_rooms(
    figures: Fence, level_m: Array, home_deg: tuple[float, float]
) -> Iterator[tuple[float, str]]:
    """Room in m that a path (M, 2), east and north of home, leaves to each figure, in words too.

    Negative is how far it gets beyond.
    """

    def place(at: tuple[float, float]) -> Array:
        return np.array(offset_m((*home_deg, 0.0), (*at, 0.0))[:2])

    for number, polygon in enumerate(figures.polygons, 1):
        corners = np.array([place(vertex) for vertex in polygon.vertices])
        room = polygon_room_m(level_m, corners, inclusion=polygon.inclusion)
        yield room, _words(f"polygon {number}", room, inclusion=polygon.inclusion)
    for number, circle in enumerate(figures.circles, 1):
        room = circle_room_m(
            level_m, place(circle.center), circle.radius_m, inclusion=circle.inclusion
        )
        yield room, _words(f"circle {number}", room, inclusion=circle.inclusion)


def _words(name: str, room_m: float, *, inclusion: bool) -> str:
    kind = "that it must stay in" if inclusion else "that it must stay out of"
    if room_m > 0:
        return f"{name} {kind}"
    return f"it gets {-room_m:.0f} m {'out of' if inclusion else 'into'} {name} {kind}"
