"""The colour and mark of each UAV, the same in every figure, page and screen."""

from __future__ import annotations

# Okabe and Ito's palette, which stays apart for all common kinds of colour blindness; yellow is
# darkened so that it shows on paper.
UAV_COLOURS = (
    "#0072B2",
    "#D55E00",
    "#009E73",
    "#CC79A7",
    "#E69F00",
    "#56B4E9",
    "#8C6D1F",
    "#000000",
)
UAV_SIGNS = "●■▲◆▼✚✖★"


def uav_colour(index: int) -> str:
    """Colour of a UAV, the same in every figure."""
    return UAV_COLOURS[index % len(UAV_COLOURS)]


def uav_sign(index: int) -> str:
    """Sign of a UAV on a terminal, like its marker in figures."""
    return UAV_SIGNS[index % len(UAV_SIGNS)]
