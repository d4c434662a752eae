"""The picture of the house, docs/images/architecture.svg, from the imports as they are.

    .venv/bin/python scripts/draw_architecture.py [--out FILE]

A box is a package, its lines the sub-packages in it. An arrow says that modules of one import
modules of the other: the more they are, the thicker the arrow.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import grimp
import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

ROOT = Path(__file__).parents[1]
# From the street up to the roof, as DESIGN.md has them; import-linter keeps them (pyproject.toml).
FLOORS = (
    ("vocabulary", ("jfto_msgs_py",)),
    ("world", ("jfto_world",)),
    ("rooms", ("jfto_planner", "jfto_topology", "jfto_power", "jfto_mavlink", "jfto_sim")),
    ("front", ("jfto",)),
)
PURPOSE = {
    "jfto": "face, commands, flights, reports",
    "jfto_planner": "where each UAV flies",
    "jfto_topology": "who is whose neighbour",
    "jfto_power": "how loudly each transmits",
    "jfto_mavlink": "missions, links, telemetry",
    "jfto_sim": "vehicles and air, simulated",
    "jfto_world": "terrain, radio, motion",
    "jfto_msgs_py": "records, files, scenario, ROS codecs",
}
WIDTH, LINE, TITLE, GAP, NICHE = 15.0, 0.24, 0.62, 0.9, 0.3
Box = tuple[float, float, float, float]


def main() -> None:
    """Read the imports and write the picture."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=ROOT / "docs/images/architecture.svg")
    draw(parser.parse_args().out)


def draw(path: Path) -> None:
    """Write the picture to a file whose suffix names its format."""
    rooms = [room for _, names in FLOORS for room in names]
    graph = grimp.build_graph(*rooms, cache_dir=None)
    inside = {room: _sub_packages(graph, room) for room in rooms}
    # The same imports give the same bytes.
    with mpl.rc_context({"svg.hashsalt": "jfto", "svg.fonttype": "none", "font.size": 9}):
        boxes, height = _places(inside)
        figure = Figure(figsize=(11, 11 * height / WIDTH), layout="constrained")
        axes = figure.add_subplot()
        axes.set(xlim=(-0.05, WIDTH + 0.05), ylim=(-0.2, height), aspect="equal")
        axes.axis("off")
        for source, target, count in _arrows(graph, rooms):
            x = _x_of(boxes[source], boxes[target], list(boxes.values()))
            _arrow(axes, x, boxes[source], boxes[target], count)
        for room, box in boxes.items():
            _room(axes, room, box, inside[room])
        metadata = {"Date": None} if path.suffix == ".svg" else {}
        figure.savefig(path, metadata=metadata)


def _sub_packages(graph: grimp.ImportGraph, room: str) -> list[str]:
    """Names of the folders in a package."""
    children = sorted(graph.find_children(room))
    return [child.rpartition(".")[2] for child in children if graph.find_children(child)]


def _arrows(graph: grimp.ImportGraph, rooms: list[str]) -> list[tuple[str, str, int]]:
    """Pairs of rooms and how many modules of the first import one of the second."""
    found = []
    for source in rooms:
        for target in rooms:
            if source != target:
                own = [source, *graph.find_descendants(source)]
                imported = [graph.find_modules_directly_imported_by(module) for module in own]
                prefix = f"{target}."
                count = sum(
                    any(each == target or each.startswith(prefix) for each in one)
                    for one in imported
                )
                if count:
                    found.append((source, target, count))
    return found


def _places(inside: dict[str, list[str]]) -> tuple[dict[str, Box], float]:
    """Box of each room, left, bottom, width, height; and the height of the whole."""
    boxes: dict[str, Box] = {}
    bottom = 0.0
    for _, rooms in FLOORS:
        columns = 1 if len(rooms) > 1 else 4
        lines = max(-(-len(inside[room]) // columns) for room in rooms)
        height = TITLE + LINE * max(lines, 1) + 0.1
        width = (WIDTH - NICHE * (len(rooms) - 1)) / len(rooms)
        for place, room in enumerate(rooms):
            boxes[room] = (place * (width + NICHE), bottom, width, height)
        bottom += height + GAP
    return boxes, bottom - GAP + 0.2


def _room(axes: Axes, room: str, box: Box, names: list[str]) -> None:
    left, bottom, width, height = box
    style = {"boxstyle": "round,pad=0,rounding_size=0.12", "facecolor": "#f4f1ea"}
    axes.add_patch(FancyBboxPatch((left, bottom), width, height, edgecolor="#444444", **style))
    top = bottom + height
    axes.text(left + 0.12, top - 0.24, room, weight="bold", va="center")
    axes.text(left + 0.12, top - 0.48, PURPOSE[room], va="center", size=7.5, color="#555555")
    columns = 1 if width < WIDTH / 2 else 4
    for place, name in enumerate(names):
        row, column = divmod(place, columns)
        x, y = left + 0.22 + column * width / columns, top - TITLE - LINE * (row + 0.4)
        axes.text(x, y, f"{name}/", va="center", size=8, family="monospace")


def _arrow(axes: Axes, x: float, source: Box, target: Box, count: int) -> None:
    """Straight down from the floor of one room to the ceiling of another, behind the others."""
    arrow = FancyArrowPatch(
        (x, source[1]),
        (x, target[1] + target[3]),
        arrowstyle="-|>",
        mutation_scale=9,
        linewidth=0.6 + 0.25 * count**0.5,
        color="#3b6ea5",
        alpha=0.75,
        zorder=0,
        shrinkA=0,
        shrinkB=0,
    )
    axes.add_patch(arrow)


def _x_of(source: Box, target: Box, boxes: list[Box]) -> float:
    """Where an arrow runs: under a narrow room, or between two of them from hall to hall."""
    narrow = min(source, target, key=lambda box: box[2])
    steps = sum(1 for box in boxes if box[2] == WIDTH and target[1] < box[1] < source[1])
    if narrow[2] < WIDTH:
        return narrow[0] + narrow[2] * (0.35 + 0.3 * steps)
    between = sorted(box[0] - NICHE / 2 for box in boxes if box[0] > 0)
    top = max(box[1] for box in boxes)
    return between[2 if source[1] < top else int(steps > 0)]


if __name__ == "__main__":
    main()
