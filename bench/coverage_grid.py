"""Areas as polygons: JFTO's photos against QGroundControl's survey grid, camera and overlap alike.

QGroundControl's survey, written anew from its documentation: parallel transects (1 - side overlap)
image widths apart, clipped at the polygon, a photo every (1 - front overlap) image heights along
each, so ceil(length ÷ distance) per transect; turnaround 0, camera straight down at a constant
height above the ground. It knows no holes, and each part is a survey of its own. Its angle is the
one of 36 that takes the fewest photos.

    python bench/coverage_grid.py [--picture FILE.png]
"""

from __future__ import annotations

import argparse
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import shapely

from jfto_msgs_py.records.plan import Waypoint
from jfto_planner.coverage import Camera, CoverageSettings, judge_waypoints, plan_coverage
from jfto_world.site import SiteArea, read_site
from jfto_world.terrain import CubicSurface, load_dem

HERE = Path(__file__).parents[1]
AREAS = {
    "field with a hole": HERE / "config/wanghai_area.geojson",
    "U": HERE / "test/data/area/u_shape.geojson",
    "two parts": HERE / "test/data/area/two_parts.geojson",
}
CAMERA = Camera(17.3, 13.0, 32.0, 5280, 3956)
DISTANCE_M = 130.0


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--overlap", type=float, nargs="+", default=[0.3, 0.7])
    options.add_argument("--picture", type=Path, help="draw what is seen of the areas at Wanghai")
    given = options.parse_args()
    print("| ground | σ | area | survey | photos | length | seen | resolution p95 | incidence p95 "
          "| pairs short | photos ÷ (area ÷ free footprint + allowance) |")  # fmt: skip
    print("|" + "---|" * 11)
    drawn = {}
    for ground in ("level", "Wanghai"):
        for overlap in given.overlap:
            settings = CoverageSettings(overlap, overlap, DISTANCE_M, min_height_m=30.0)
            for name, path in AREAS.items():
                dem = ground_of(path, level=ground == "level")
                ours = plan_coverage(dem, CAMERA, settings)
                theirs = judge_waypoints(tuple(survey_grid(dem, overlap)), dem, CAMERA, settings)
                for who, found in (("JFTO", ours), ("QGC", theirs)):
                    print(f"| {ground} | {overlap:g} | {name} | {who} {row(found, dem, overlap)}")
                if ground == "Wanghai" and overlap == given.overlap[0]:
                    drawn[name] = (dem, ours)
    if given.picture:
        draw(drawn, given.picture)


def ground_of(path: Path, *, level: bool):
    area = SiteArea(path.name, tuple(p for s in read_site(path).shapes for p in s.polygons))
    centre = area.middle_deg
    dem = load_dem("jacksboro", center=centre, size_m=area.window_m(centre))
    if level:
        x, y, z = dem.grid()
        surface = CubicSurface.through(0 * z, x[0], y[0], x[1] - x[0], y[1] - y[0])
        dem = replace(dem, surface=surface)
    return replace(dem, area=area.local(dem.frame))


def survey_grid(dem, overlap: float) -> list[Waypoint]:
    """Photos of QGroundControl's survey, in the order flown."""
    width, height = CAMERA.footprint_m(DISTANCE_M)
    spacing, trigger = (1 - overlap) * width, (1 - overlap) * height
    photos = []
    for part in dem.area:
        outline = shapely.Polygon(part.outer)
        layouts = [transects(outline, angle, spacing) for angle in np.arange(0.0, 180.0, 5.0)]
        lines = min(layouts, key=lambda found: sum(math.ceil(x.length / trigger) for x in found))
        for number, line in enumerate(lines):
            flown = line.reverse() if number % 2 else line
            (x0, y0), (x1, y1) = flown.coords
            heading = math.degrees(math.atan2(x1 - x0, y1 - y0)) % 360
            for k in range(math.ceil(line.length / trigger)):
                at = flown.interpolate(k * trigger)
                up = float(dem.height(at.x, at.y)) + DISTANCE_M
                photos.append(Waypoint(len(photos), (at.x, at.y, up), heading))
    return photos


def transects(outline: shapely.Polygon, heading_deg: float, spacing_m: float):
    """Lines through the middle of the bounds and beside it, clipped at the outline."""
    turned = shapely.affinity.rotate(outline, heading_deg, origin=(0, 0))
    west, south, east, north = turned.bounds
    middle, reach = (west + east) / 2, (east - west) / 2
    count = math.floor(reach / spacing_m)
    found = []
    for k in range(-count, count + 1):
        x = middle + k * spacing_m
        cut = turned.intersection(shapely.LineString([(x, south - 1), (x, north + 1)]))
        found += [p for p in shapely.get_parts(cut) if p.geom_type == "LineString"]
    return [shapely.affinity.rotate(line, -heading_deg, origin=(0, 0)) for line in found]


def row(found, dem, overlap: float) -> str:
    free_m2 = (1 - overlap) ** 2 * math.prod(CAMERA.footprint_m(DISTANCE_M))
    proof, pairs = found.certificate, found.overlaps
    # Half a photo's free side all along the outline.
    allowance = dem.area_shape.length * math.sqrt(free_m2) / 2 / free_m2
    share = len(found.waypoints) / (proof.surface_m2 / free_m2 + allowance)
    return (
        f"| {len(found.waypoints)} | {tour_m(found.waypoints) / 1000:.2f} km "
        f"| {100 * proof.seen_once:.1f} % | {100 * proof.gsd_p95_m:.2f} cm "
        f"| {proof.incidence_p95_deg:.0f}° "
        f"| {pairs.below} of {pairs.across.pairs + pairs.along.pairs} | {share:.2f} |"
    )


def tour_m(waypoints) -> float:
    """Length of an open way through all photos: from row to row, then 2-opt."""
    points = np.array([w.position_m for w in waypoints])
    away = np.linalg.norm(points[:, None] - points[None], axis=-1)
    order, left = [0], set(range(1, len(points)))
    while left:
        order.append(min(left, key=lambda k: away[order[-1], k]))
        left.remove(order[-1])
    best, better = np.array(order), True
    while better:
        better = False
        for i in range(len(best) - 1):
            j = np.arange(i + 1, len(best))
            before = away[best[i - 1], best[i]] if i else 0.0
            start = away[best[i - 1], best[j]] if i else 0.0
            ends = np.append(best, best[-1])
            last = j == len(best) - 1
            gain = before + np.where(last, 0, away[best[j], ends[j + 1]])
            gain = gain - start - np.where(last, 0, away[best[i], ends[j + 1]])
            if gain.max() > 1e-6:
                stop = int(j[np.argmax(gain)])
                best[i : stop + 1] = best[i : stop + 1][::-1]
                better = True
    return float(away[best[:-1], best[1:]].sum())


def draw(drawn, path: Path) -> None:
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(1, len(drawn), figsize=(11, 3.6), layout="constrained")
    for axis, (name, (dem, found)) in zip(axes, drawn.items(), strict=True):
        proof = found.certificate
        seen = np.ma.masked_where(~proof.inside, np.minimum(proof.views, 4))
        mesh = axis.pcolormesh(proof.x_m, proof.y_m, seen, vmin=-0.5, vmax=4.5, rasterized=True,
                               cmap=plt.get_cmap("viridis", 5))  # fmt: skip
        for part in dem.area:
            for ring in (part.outer, *part.holes):
                axis.plot(*np.array([*ring, ring[0]]).T, color="black", linewidth=1)
        places = np.array([w.position_m for w in found.waypoints])
        axis.plot(*places[:, :2].T, ".", color="white", markeredgecolor="black",
                  markeredgewidth=0.3, markersize=4)  # fmt: skip
        axis.set_aspect("equal")
        axis.set_title(f"{name}: {len(places)} photos, {100 * proof.seen_once:.1f} % seen, rows "
                       f"{found.heading_deg:.0f}°", fontsize=9)  # fmt: skip
        axis.set_xlabel("East of origin (m)", fontsize=8)
        axis.tick_params(labelsize=7)
    axes[0].set_ylabel("North of origin (m)", fontsize=8)
    figure.colorbar(mesh, ax=axes, ticks=range(5), label="photos that show it (4: or more)")
    figure.savefig(path, dpi=100)


if __name__ == "__main__":
    main()
