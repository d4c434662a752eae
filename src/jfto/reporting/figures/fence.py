"""No-fly zones and what is to be kept in, on maps and in the three-dimensional view."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from jfto.reporting.figures.style import TROUBLE_COLOUR
from jfto_msgs_py.records.plan import Origin
from jfto_msgs_py.records.site import Fence, Zone
from jfto_msgs_py.types import Array
from jfto_world.terrain import Dem

_KEEP_IN_COLOUR = "#0B6E4F"
_CIRCLE_CORNERS = 72


def zone_ring(zone: Zone) -> Array:
    """Closed outline (K, 2) of a zone, ENU metres."""
    if zone.radius_m > 0:
        turns = np.linspace(0.0, 2.0 * np.pi, _CIRCLE_CORNERS + 1)
        circle = np.column_stack([np.cos(turns), np.sin(turns)])
        return np.asarray(np.array(zone.centre_m) + zone.radius_m * circle)
    return np.array([*zone.outer, zone.outer[0]], dtype=np.float64)


def draw_fence(axes: Axes, fence: Fence | None, origin: Origin) -> None:
    """Zones filled and named with their heights above sea level, what is kept in as a line."""
    if fence is None:
        return
    for index, zone in enumerate(fence.keep_out):
        ring = zone_ring(zone)
        axes.fill(
            *ring.T,
            facecolor=(*_rgb(TROUBLE_COLOUR), 0.18),
            edgecolor=TROUBLE_COLOUR,
            hatch="///",
            linewidth=1.0,
            zorder=2.5,
            label="no-fly zone" if index == 0 else None,
        )
        axes.annotate(
            zone.name + heights_text(zone, origin),
            ring[:-1].mean(axis=0),
            ha="center",
            va="center",
            fontsize=5.5,
            color=TROUBLE_COLOUR,
            zorder=7,
            annotation_clip=True,
            bbox={
                "boxstyle": "round,pad=0.15",
                "facecolor": "white",
                "edgecolor": "none",
                "alpha": 0.8,
            },
        )
    rings = [ring for part in fence.keep_in for ring in (part.outer, *part.holes)]
    for index, corners in enumerate(rings):
        axes.plot(
            *np.array([*corners, corners[0]]).T,
            color=_KEEP_IN_COLOUR,
            linewidth=1.2,
            zorder=2.4,
            label="to stay in" if index == 0 else None,
        )


def heights_text(zone: Zone, origin: Origin) -> str:
    """Bottom and top of a zone above sea level, empty where it has neither."""
    parts = []
    if zone.bottom_m is not None:
        parts.append(f"from {zone.bottom_m + origin.alt_m:.0f} m")
    if zone.top_m is not None:
        parts.append(f"to {zone.top_m + origin.alt_m:.0f} m")
    return f" ({' '.join(parts)})" if parts else ""


def fence_scene(fence: Fence | None, dem: Dem | None, highest_m: float) -> list[dict[str, Any]]:
    """Walls of zones for the three-dimensional view, from the ground up to `highest_m` at most."""
    if fence is None:
        return []
    found = []
    for zone in fence.keep_out:
        ring = zone_ring(zone)
        low = np.full(len(ring), -np.inf if zone.bottom_m is None else zone.bottom_m)
        if dem is not None:
            known = dem.contains(*ring.T)
            low[known] = np.maximum(low[known], dem.height(*ring[known].T))
        top = highest_m if zone.top_m is None else min(zone.top_m, highest_m)
        low[~np.isfinite(low)] = min(top, 0.0)
        low = np.minimum(low, top)
        found.append(
            {
                "name": zone.name,
                "x": [ring[:, 0].tolist()] * 2,
                "y": [ring[:, 1].tolist()] * 2,
                "z": [low.tolist(), [top] * len(ring)],
            }
        )
    return found


def _rgb(colour: str) -> tuple[float, float, float]:
    red, green, blue = (int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5))
    return red, green, blue
