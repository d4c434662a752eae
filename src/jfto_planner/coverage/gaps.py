"""Where further photos would show most of what is still unseen."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from jfto_msgs_py.types import Array
from jfto_planner.coverage.certificate import CoverageCertificate


def gap_centres(
    certificate: CoverageCertificate, window_m: float, most: int, may_stay: float
) -> Array:
    """Points (K, 2), x and y, around which most ground is unseen, the worst first, K ≤ `most`.

    Greedy: the square window of side `window_m` with the most unseen samples is taken, its samples
    count as seen, and so on until at most the share `may_stay` of all is left.
    """
    x, y = certificate.x_m, certificate.y_m
    unseen = certificate.views == 0
    size = (_odd(window_m / (y[1] - y[0])), _odd(window_m / (x[1] - x[0])))
    centres: list[tuple[float, float]] = []
    while unseen.mean() > may_stay and len(centres) < most:
        count = ndimage.uniform_filter(unseen.astype(np.float64), size, mode="constant")
        # The window's unseen samples may lie in a corner of it: aim at their middle.
        row, column = np.unravel_index(int(np.argmax(np.round(count, 9))), count.shape)
        window = (
            slice(max(0, row - size[0] // 2), row + size[0] // 2 + 1),
            slice(max(0, column - size[1] // 2), column + size[1] // 2 + 1),
        )
        rows, columns = np.nonzero(unseen[window])
        centres.append(
            (
                float(x[window[1]][columns].mean()),
                float(y[window[0]][rows].mean()),
            )
        )
        unseen[window] = False
    return np.array(centres).reshape(-1, 2)


def _odd(samples: float) -> int:
    return max(1, int(samples) | 1)
