"""What all maps share: shaded relief, axes, pads, scale bar and north arrow."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.transforms import ScaledTranslation, Transform

from jfto.reporting.figures.fence import draw_fence
from jfto.reporting.figures.style import PAGE_WIDTH_IN, new_figure
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.records.site import Polygon
from jfto_msgs_py.types import Array
from jfto_world.terrain import Dem

# Pale and almost without hue, so that routes stay the only saturated thing on the map.
_PALE = LinearSegmentedColormap.from_list("relief", ["#cfdcc6", "#e9e3cf", "#f1e9dc", "#e4dcd4"])
_PIXELS = 400
# What arrow and scale bar take below the legend.
_MARGIN_IN = 1.1
_NICE = np.array([1.0, 2.0, 5.0])


def new_map(plan: Plan, dem: Dem, fade: float = 0.0) -> tuple[Figure, Axes]:
    """Hillshade of the area with all waypoints and pads; `fade` 0 … 1 pales it."""
    points = np.array([w.position_m for w in plan.waypoints] + [u.start_m for u in plan.uavs])
    extent = drawn_extent(dem, points)
    ratio = extent[1] / extent[0]
    figure = new_figure(PAGE_WIDTH_IN, min(8.5, 0.59 * PAGE_WIDTH_IN * ratio + 0.5))
    axes = figure.add_subplot()
    draw_relief(axes, dem, extent, fade)
    draw_fence(axes, plan.fence, plan.origin)
    axes.set_xlabel("East of origin (m)")
    axes.set_ylabel("North of origin (m)")
    return figure, axes


def draw_pad(axes: Axes, start_m: tuple[float, float, float], colour: str) -> None:
    """A pad in its UAV's colour."""
    axes.plot(
        *start_m[:2],
        marker="s",
        markersize=7,
        markerfacecolor="white",
        markeredgecolor=colour,
        markeredgewidth=1.6,
        zorder=6,
    )


def finish_map(axes: Axes, title: str | None = None) -> None:
    """Scale, north and the legend, which explains pads too; to be called last."""
    axes.plot(
        [], [], "s", markersize=6, markerfacecolor="white", markeredgecolor="black", label="pad"
    )
    legend = axes.legend(
        loc="upper left",
        bbox_to_anchor=(1.02, 1.0),
        borderaxespad=0.0,
        title=title,
        alignment="left",
    )
    figure = axes.figure
    assert isinstance(figure, Figure)
    figure.draw_without_rendering()
    left_in = (legend.get_window_extent().y0 - axes.get_window_extent().y0) / figure.dpi
    if left_in > _MARGIN_IN:
        draw_scale_bar(axes)
        draw_north_arrow(axes, outside=True)
    else:
        # Beside a wide map the legend takes all the height.
        draw_scale_bar(axes, np.concatenate([line.get_xydata() for line in axes.lines]))
        draw_north_arrow(axes)


def sampled_ground(dem: Dem, half_extent_m: tuple[float, float], pixels: int) -> tuple[Array, ...]:
    """Ground on a regular grid about the origin: x (nx,), y (ny,), z (ny, nx) in metres."""
    half_x, half_y = half_extent_m
    longest = max(half_x, half_y)
    x = np.linspace(-half_x, half_x, max(2, round(pixels * half_x / longest)))
    y = np.linspace(-half_y, half_y, max(2, round(pixels * half_y / longest)))
    return x, y, dem.height(*np.meshgrid(x, y))


def drawn_extent(dem: Dem, points_m: Array) -> tuple[float, float]:
    """Half extent of a map that shows the area and all points (…, 2 or 3), within the DEM."""
    flat = np.abs(points_m.reshape(-1, points_m.shape[-1]))
    wanted = [
        max(0.5 * dem.size_m[axis], float(flat[:, axis].max(initial=0.0))) * 1.03 for axis in (0, 1)
    ]
    return min(wanted[0], dem.half_extent_m[0]), min(wanted[1], dem.half_extent_m[1])


def draw_relief(
    axes: Axes, dem: Dem, half_extent_m: tuple[float, float], fade: float = 0.0
) -> None:
    """Hillshade, contour lines and the area's outline, behind a map; `fade` 0 … 1 pales it."""
    x, y, z = sampled_ground(dem, half_extent_m, _PIXELS)
    tint = _PALE((z - z.min()) / max(float(np.ptp(z)), 1e-9))[..., :3]
    shaded = np.clip(tint * _shade(x, y, z)[..., None], 0, 1)
    axes.imshow(
        shaded * (1 - fade) + fade,
        extent=(x[0], x[-1], y[0], y[-1]),
        origin="lower",
        interpolation="bilinear",
        zorder=0,
    )
    _draw_contours(axes, x, y, z + dem.origin.alt_m, labelled=fade == 0)
    for index, ring in enumerate(area_rings(dem.area)):
        label = "area" if index == 0 else None
        axes.plot(
            *ring.T, color="#1c2430", linewidth=1.1, linestyle=(0, (5, 2)), zorder=2, label=label
        )
    axes.set_aspect("equal")
    axes.set_xlim(x[0], x[-1])
    axes.set_ylim(y[0], y[-1])


def area_rings(area: tuple[Polygon, ...]) -> list[Array]:
    """Closed outlines of an area and of its holes, (K, 2) each, ENU metres."""
    return [
        np.array([*ring, ring[0]], dtype=np.float64)
        for part in area
        for ring in (part.outer, *part.holes)
    ]


def _shade(x: Array, y: Array, z: Array) -> Array:
    """Brightness under light from the north-west, 45° high; 1 on level ground."""
    north, east = np.gradient(z, y, x)
    facing = (1.0 + (east - north) / np.sqrt(2.0)) / np.sqrt(1.0 + east**2 + north**2)
    return np.clip(0.45 + 0.55 * facing, 0.4, 1.12)


def _draw_contours(axes: Axes, x: Array, y: Array, altitude_m: Array, *, labelled: bool) -> None:
    step = nice_length(max(float(np.ptp(altitude_m)), 1e-3) / 5)
    levels = np.arange(np.ceil(altitude_m.min() / step) * step, altitude_m.max(), step)
    if not levels.size:
        return
    lines = axes.contour(
        x, y, altitude_m, levels=levels, colors="#6d6350", linewidths=0.35, alpha=0.6, zorder=1
    )
    if labelled:
        axes.clabel(lines, fmt="%g m", fontsize=5, colors="#5d5443")


def draw_scale_bar(axes: Axes, points_m: Array | None = None) -> None:
    """Scale bar of a round length, under the map's right margin or in its emptiest lower corner.

    Without `points_m` (K, 2) it stands outside, right of the map; with them inside, in the lower
    corner that fewer of the points lie in.
    """
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    width, height = right - left, top - bottom
    length = nice_length(width / 4)
    x, y = right + 0.06 * width, bottom + 0.02 * height
    if points_m is not None:
        low = points_m[points_m[:, 1] < bottom + 0.2 * height, 0]
        on_left = (low < left + 0.4 * width).sum() <= (low > right - 0.4 * width).sum()
        x = left + 0.05 * width if on_left else right - 0.05 * width - length
        y = bottom + 0.035 * height
    thickness = 0.010 * height
    for part, colour in enumerate(("black", "white")):
        axes.add_patch(
            Rectangle(
                (x + part * length / 2, y),
                length / 2,
                thickness,
                facecolor=colour,
                edgecolor="black",
                linewidth=0.5,
                clip_on=False,
                zorder=9,
            )
        )
    axes.text(
        x + length / 2,
        y + 1.6 * thickness,
        f"{length / 1000:g} km" if length >= 1000 else f"{length:g} m",
        ha="center",
        va="bottom",
        fontsize=7,
        zorder=9,
    )


def draw_north_arrow(axes: Axes, *, outside: bool = False) -> None:
    """North arrow right of the map or in its upper right corner; maps have north up."""
    # Anchored to a corner at a fixed distance in points, whatever the map's proportions.
    corner, right_pt, up_pt = ((1.0, 0.0), 34.0, 62.0) if outside else ((1.0, 1.0), -12.0, -6.0)

    def place(offset_pt: float) -> Transform:
        assert axes.figure is not None
        shift = ScaledTranslation(right_pt / 72, offset_pt / 72, axes.figure.dpi_scale_trans)
        return axes.transAxes + shift

    axes.annotate(
        "N",
        xy=corner,
        xycoords=place(up_pt),
        xytext=corner,
        textcoords=place(up_pt - 24),
        ha="center",
        va="center",
        fontsize=8,
        fontweight="bold",
        arrowprops={"arrowstyle": "-|>", "color": "black", "linewidth": 1.0},
        annotation_clip=False,
        zorder=9,
    )


def nice_length(length: float) -> float:
    """Largest of 1, 2, 5 × 10^k that does not exceed `length`."""
    power = 10.0 ** np.floor(np.log10(length))
    return float(_NICE[_NICE * power <= length * (1 + 1e-9)].max() * power)
