"""Data of the report's three-dimensional view."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from jfto.comparison import AlgorithmResult, Comparison
from jfto.figures.relief import drawn_extent, sampled_ground
from jfto.flown import flown
from jfto.palette import uav_colour
from jfto_msgs_py.plan import Plan
from jfto_msgs_py.units import dbm_to_w, ratio_to_db
from jfto_world.terrain import Dem

_GROUND_POINTS = 90
# Of a flight's samples so few are drawn, one per second.
_PATH_STEPS = 20


def scene_data(plan: Plan, comparison: Comparison, dem: Dem) -> dict[str, Any]:
    """Terrain, routes, positions and links of every slot; lengths in metres, margins in dB."""
    x, y, z = sampled_ground(dem, drawn_extent(dem, plan.positions_m), _GROUND_POINTS)
    sensitivity_w = float(dbm_to_w(plan.radio.sensitivity_dbm))
    by_id = {waypoint.id: waypoint.position_m for waypoint in plan.waypoints}
    return {
        "terrain": {"x": _short(x), "y": _short(y), "z": _short(z)},
        "duration": plan.slots.duration_s,
        "uavs": [
            {
                "id": uav.id,
                "color": uav_colour(index),
                "route": _short(
                    np.array([uav.start_m, *(by_id[number] for number in route.waypoint_ids)])
                ),
                "path": _short(flight.position_m[::_PATH_STEPS]),
                "waypoints": list(route.waypoint_ids),
                "arrival": _short(np.array(route.arrival_s)),
            }
            for index, (uav, route, flight) in enumerate(
                zip(plan.uavs, plan.routes, flown(plan), strict=True)
            )
        ],
        "positions": _short(np.moveaxis(plan.positions_m, 0, 1)),
        "links": {
            result.name: _links(result, comparison.gain / sensitivity_w)
            for result in comparison.results
        },
        "throughput": {
            result.name: [round(value / 1e6) for value in result.linked.throughput_bps]
            for result in comparison.results
        },
    }


def _links(result: AlgorithmResult, gain: NDArray[np.float64]) -> list[list[list[float]]]:
    """For each slot its links as [a, b, margin in dB]."""
    weaker = np.minimum(result.power_w[:, :, None], result.power_w[:, None, :])
    margin = ratio_to_db(weaker * gain)
    slots = []
    for linked, level in zip(result.linked.links, margin, strict=True):
        first, second = np.nonzero(np.triu(linked))
        slots.append(
            [
                [int(a), int(b), round(float(level[a, b]), 1)]
                for a, b in zip(first, second, strict=True)
            ]
        )
    return slots


def _short(values: NDArray[np.float64]) -> Any:
    """Nested lists to a decimetre: a report is looked at, not computed with."""
    return np.round(values, 1).tolist()
