"""What the paper reports (table_connectivity, table_PE), to be printed beside our own figures.

Its throughput column is headed Kb/s; with its own bandwidth and noise the figures fit Mb/s, the
mean over the slots, and are compared as such.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class PaperRow:
    """One algorithm in one scene of the paper; `hops` is None where the paper gives none."""

    traverses_all: bool
    connectivity_rate: float
    throughput: float
    hops: float | None


# Scene of the paper: algorithm: its row.
PAPER: dict[str, dict[str, PaperRow]] = {
    "small": {
        "MTP": PaperRow(False, 0.9496, 1.90e3, math.inf),
        "A-LMST": PaperRow(True, 0.8172, 6.94e2, 1.64),
        "CPAPO": PaperRow(True, 0.8974, 9.50e2, 1.32),
        "C-TOP": PaperRow(True, 0.9720, 1.93e3, 1.18),
    },
    "wanglang": {
        "MTP": PaperRow(False, 0.3969, 8.28e3, math.inf),
        "A-LMST": PaperRow(True, 0.6376, 4.47e3, 2.61),
        "CPAPO": PaperRow(True, 0.7722, 7.65e3, 1.85),
        "C-TOP": PaperRow(True, 0.8821, 9.89e3, 1.59),
    },
    "wanglang_gaussian": {
        "MTP": PaperRow(False, 0.3780, 6.36e3, math.inf),
        "A-LMST": PaperRow(True, 0.7289, 4.26e3, 2.64),
        "CPAPO": PaperRow(True, 0.9303, 9.07e3, 1.73),
        "C-TOP": PaperRow(True, 0.9536, 1.07e4, 1.61),
    },
    "wanghai": {
        "MTP": PaperRow(False, 0.6361, 5.39e3, None),
        "A-LMST": PaperRow(True, 0.7452, 4.49e3, None),
        "CPAPO": PaperRow(True, 0.8600, 6.21e3, None),
        "C-TOP": PaperRow(True, 0.9139, 7.71e3, None),
    },
}
