"""Data of the report's three-dimensional view."""

from __future__ import annotations

from typing import Any

import numpy as np

from jfto.analysis.comparison import Comparison
from jfto.analysis.facts import FlightFacts
from jfto.analysis.grid import FINER
from jfto.analysis.motion import motions
from jfto.analysis.record import Track
from jfto.reporting.figures.fence import fence_scene
from jfto.reporting.figures.map import area_rings, drawn_extent, sampled_ground
from jfto.reporting.palette import uav_colour
from jfto_msgs_py.files import plain
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.types import Array, Flags
from jfto_msgs_py.units import dbm_to_w, ratio_to_db
from jfto_world.terrain import Dem

_GROUND_POINTS = 90
# Of a flight's samples so few are drawn, one per second.
_PATH_STEPS = 20
_TRACK_STEP_S = 1.0
# The area's outline follows the ground in such steps, so high above it that it is not hidden.
_OUTLINE_STEP_M, _OUTLINE_LIFT_M = 10.0, 2.0
# What the view calls the flight, beside the algorithms.
FLOWN = "C-TOP as flown"


def scene_data(
    plan: Plan, comparison: Comparison, dem: Dem | None, facts: FlightFacts | None = None
) -> dict[str, Any]:
    """Terrain, routes, positions and links of every slot; lengths in metres, margins in dB.

    Terrain that is not known (`dem` is None) is empty. With `facts` also the tracks that
    were flown, under "flown".
    """
    x, y, z = (np.zeros(0),) * 3
    if dem is not None:
        x, y, z = sampled_ground(dem, drawn_extent(dem, plan.positions_m), _GROUND_POINTS)
    sensitivity_w = float(dbm_to_w(plan.radio.sensitivity_dbm))
    return {
        "terrain": {"x": _short(x), "y": _short(y), "z": _short(z)},
        "area": [] if dem is None else [_short(on_ground(r, dem)) for r in area_rings(plan.area)],
        "fence": plain(fence_scene(plan.fence, dem, float(plan.positions_m[..., 2].max())), 1),
        "duration": plan.slots.duration_s,
        "uavs": [
            {
                "id": uav.id,
                "color": uav_colour(index),
                "route": _short(plan.line_m(index)),
                "path": _short(flight.position_m[::_PATH_STEPS]),
                "waypoints": list(route.waypoint_ids),
                "arrival": _short(np.array(route.arrival_s)),
            }
            for index, (uav, route, flight) in enumerate(
                zip(plan.uavs, plan.routes, motions(plan), strict=True)
            )
        ],
        "positions": _short(np.moveaxis(plan.positions_m, 0, 1)),
        "links": {
            result.name: _links(
                result.linked.links, result.power_w, comparison.gain / sensitivity_w
            )
            for result in comparison.results
        },
        "throughput": {
            result.name: [round(value / 1e6) for value in result.linked.throughput_bps]
            for result in comparison.results
        },
        "flown": None if facts is None else _flown(facts, sensitivity_w),
    }


def on_ground(ring: Array, dem: Dem) -> Array:
    """A closed outline (K, 2) as a line on the ground (M, 3), where the ground is known."""
    steps = np.linalg.norm(np.diff(ring, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    at = np.union1d(along, np.arange(0.0, along[-1], _OUTLINE_STEP_M))
    points = np.stack([np.interp(at, along, axis) for axis in ring.T], axis=-1)
    points = points[dem.contains(*points.T)]
    return np.column_stack([points, dem.height(*points.T) + _OUTLINE_LIFT_M])


def _flown(facts: FlightFacts, sensitivity_w: float) -> dict[str, Any]:
    """Tracks, and for each slot flown places, links and throughput in the middle of it."""
    network, grid = facts.network, facts.grid
    places = np.where(grid.present[..., None], grid.position_m, np.nan)[grid.middles]
    return {
        "name": FLOWN,
        "tracks": [_track(facts.flight.tracks[uav]) for uav in facts.flight.uav_ids],
        "positions": _short(places),
        "begin": _short(grid.times_s[::FINER]),
        "links": _links(network.links, network.power_w, network.gain / sensitivity_w),
        "throughput": [round(value / 1e6) for value in network.throughput_bps],
    }


def _track(track: Track) -> Any:
    """About one place per second from lift-off to the end."""
    if not track.times_s.size:
        return []
    times = np.arange(0.0, max(float(track.times_s[-1]), 0.0) + _TRACK_STEP_S, _TRACK_STEP_S)
    return _short(track.at(times))


def _links(links: Flags, power_w: Array, gain: Array) -> list[list[list[float]]]:
    """For each slot its links as [a, b, margin in dB]; `gain` is over the sensitivity."""
    weaker = np.minimum(power_w[:, :, None], power_w[:, None, :])
    margin = ratio_to_db(weaker * gain)
    slots = []
    for linked, level in zip(links, margin, strict=True):
        first, second = np.nonzero(np.triu(linked))
        slots.append(
            [
                [int(a), int(b), round(float(level[a, b]), 1)]
                for a, b in zip(first, second, strict=True)
            ]
        )
    return slots


def _short(values: Array) -> Any:
    """Nested lists to a decimetre: a report is looked at, not computed with. Unknown is null."""
    return plain(values, 1)
