"""One look for all figures: colours, markers, sizes and how they are saved."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Any, ParamSpec

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from jfto.reporting.palette import UAV_COLOURS, uav_colour

P = ParamSpec("P")

UAV_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")
UAV_DASHES: tuple[Any, ...] = ("-", (0, (5, 1.5)), (0, (1.5, 1.2)))
ALGORITHM_STYLES: dict[str, dict[str, Any]] = {
    "MTP": {"color": "#555555", "linestyle": (0, (5, 1.5))},
    "A-LMST": {"color": "#E69F00", "linestyle": (0, (1.5, 1.2))},
    "CPAPO": {"color": "#009E73", "linestyle": (0, (6, 1.5, 1.5, 1.5))},
    "C-TOP literal": {"color": "#56B4E9", "linestyle": (0, (5, 1.5))},
    "C-TOP closed": {"color": "#CC79A7", "linestyle": (0, (1.5, 1.2))},
    "C-TOP elastic": {"color": "#0072B2", "linestyle": "-"},
}
PLANNED_STYLE: dict[str, Any] = {"color": "#777777", "linestyle": (0, (5, 1.5)), "linewidth": 1.2}
FLOWN_STYLE: dict[str, Any] = {"color": "#0072B2", "linestyle": "-", "linewidth": 1.4}
# What broke a rule, on maps and over time.
TROUBLE_COLOUR = "#A50034"
PAGE_WIDTH_IN = 7.16
_SETTINGS: Any = {
    "font.size": 8,
    "font.family": "DejaVu Sans",
    "axes.titlesize": 8,
    "axes.labelsize": 8,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "legend.fontsize": 7,
    "legend.frameon": False,
    "lines.linewidth": 1.2,
    "figure.constrained_layout.use": True,
    "pdf.fonttype": 42,
}


def uav_style(index: int, marker_size: float) -> dict[str, Any]:
    """Colour, line and marker of a UAV, so that colour is never the only sign.

    Lines change once the colours are used up; markers look as large as one another.
    """
    marker = UAV_MARKERS[index % len(UAV_MARKERS)]
    return {
        "color": uav_colour(index),
        "linestyle": UAV_DASHES[index // len(UAV_COLOURS) % len(UAV_DASHES)],
        "marker": marker,
        "markersize": marker_size * (1.45 if marker == "*" else 1.0),
    }


def new_figure(width_in: float, height_in: float, **options: Any) -> Figure:
    """Empty figure of a given size in inches, in the common style."""
    with mpl.rc_context(_SETTINGS):
        return Figure(figsize=(width_in, height_in), **options)


def styled(function: Callable[P, Figure]) -> Callable[P, Figure]:
    """Draw inside the common style: matplotlib reads its settings when artists are made."""

    @wraps(function)
    def wrapped(*args: P.args, **kwargs: P.kwargs) -> Figure:
        with mpl.rc_context(_SETTINGS):
            return function(*args, **kwargs)

    return wrapped


def rule(axes: Axes) -> None:
    """Thin lines across a panel, to read values by."""
    axes.grid(axis="y", linewidth=0.4, color="#dddddd")


def save(figure: Figure, path: Path) -> tuple[Path, Path]:
    """Write `path`.png for the screen and `path`.pdf for print, the same bytes each time."""
    png, pdf = path.with_suffix(".png"), path.with_suffix(".pdf")
    figure.savefig(png, dpi=220, metadata={"Software": None})
    figure.savefig(pdf, metadata={"CreationDate": None})
    return png, pdf
