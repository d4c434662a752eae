"""The comparison in words, beside what the paper reports (table_connectivity, table_PE).

The paper's throughput column is headed Kb/s. A mean over slots in Mb/s it cannot be: a link at the
sensitivity has 40 dB, 1110 Mb/s, and A-LMST has at least A - 1 of them. What fits, with nothing
fitted, is the sum of log10(1 + SNR) over links and slots; the figures stand beside that, and as
ratios.
"""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass

from jfto.analysis.comparison import FORM_NAMES, AlgorithmResult, Comparison

OURS = "C-TOP"


@dataclass(frozen=True)
class PaperRow:
    """One algorithm in one scene of the paper; `hops` is None where the paper gives none.

    `throughput` is what stands in its column, see above.
    """

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
        OURS: PaperRow(True, 0.9720, 1.93e3, 1.18),
    },
    "wanglang": {
        "MTP": PaperRow(False, 0.3969, 8.28e3, math.inf),
        "A-LMST": PaperRow(True, 0.6376, 4.47e3, 2.61),
        "CPAPO": PaperRow(True, 0.7722, 7.65e3, 1.85),
        OURS: PaperRow(True, 0.8821, 9.89e3, 1.59),
    },
    "wanglang_gaussian": {
        "MTP": PaperRow(False, 0.3780, 6.36e3, math.inf),
        "A-LMST": PaperRow(True, 0.7289, 4.26e3, 2.64),
        "CPAPO": PaperRow(True, 0.9303, 9.07e3, 1.73),
        OURS: PaperRow(True, 0.9536, 1.07e4, 1.61),
    },
    "wanghai": {
        "MTP": PaperRow(False, 0.6361, 5.39e3, None),
        "A-LMST": PaperRow(True, 0.7452, 4.49e3, None),
        "CPAPO": PaperRow(True, 0.8600, 6.21e3, None),
        OURS: PaperRow(True, 0.9139, 7.71e3, None),
    },
}

# What `beside_paper` gives, in its order.
HEADINGS = (
    "Traverses all",
    "ξ (%)",
    "Σ log10(1 + SNR)",
    "Hops",
    "Throughput (Mb/s)",
    "One band (Mb/s)",
)

# What `ground_cells` gives: Mb/s where each radio has its own time / where all share one band.
GROUND_HEADINGS = ("To ground (Mb/s)", "No way to it")


def beside_paper(result: AlgorithmResult, scene: str) -> list[tuple[str, str]]:
    """An algorithm's figures and the paper's, as texts; those are empty where it gives none."""
    linked = result.linked
    ours = _cells(result.traverses_all, linked.connectivity_rate, result.decades, linked.hops)
    theirs = paper_row(scene, result.name)
    beside = [""] * len(ours) if theirs is None else _cells(*astuple(theirs))
    shared = result.one_band.throughput_bps[1:].mean() / 1e6
    without = [(f"{mbps:.0f}", "") for mbps in (linked.mean_throughput_mbps, shared)]
    return [*zip(ours, beside, strict=True), *without]


def paper_row(scene: str, algorithm: str) -> PaperRow | None:
    """The paper's row of an algorithm, its one of C-TOP for each of the forms; None without."""
    name = OURS if algorithm in FORM_NAMES.values() else algorithm
    return PAPER.get(scene, {}).get(name)


def ground_cells(result: AlgorithmResult) -> list[str]:
    """Rates to the ground and who has no way to it, under `GROUND_HEADINGS`; empty without."""
    if result.ground is None:
        return []
    own, shared = result.ground.mean_mbps
    return [f"{own:.0f} / {shared:.0f}", f"{100 * result.ground.deaf_share:.0f} %"]


def ratios_text(comparison: Comparison, scene: str) -> str:
    """These ratios with the paper's, as "1.64 × A-LMST (paper 2.78), …"; empty without any."""
    rows = PAPER.get(scene)
    theirs = {} if rows is None else {n: rows[OURS].throughput / rows[n].throughput for n in rows}
    return ", ".join(
        f"{ratio:.2f} × {name}" + (f" (paper {theirs[name]:.2f})" if name in theirs else "")
        for name, ratio in comparison.throughput_ratios.items()
    )


def active_text(comparison: Comparison) -> str:
    """What the listed links of the plan's C-TOP alone are worth, in one sentence."""
    active = comparison.ours.active
    return (
        "A link is any pair that hears each other, for all algorithms alike. The listed links of "
        f"{comparison.ours.name} alone carry {active.mean_throughput_mbps:.0f} Mb/s, with ξ "
        f"{100 * active.connectivity_rate:.1f} % and {active.hops:.2f} hops."
    )


def number(value: float | None, decimals: int, *, signed: bool = False) -> str:
    """A number with its digits, in words where it is not finite, a dash where it is unknown."""
    if value is None or math.isnan(value):
        return "–"
    if math.isinf(value):
        return "inf" if value > 0 else "-inf"
    return f"{value:{'+' if signed else ''}.{decimals}f}"


def _cells(traverses_all: bool, rate: float, sum_: float, hops: float | None) -> list[str]:
    return ["yes" if traverses_all else "no", f"{100 * rate:.1f}", f"{sum_:.0f}", number(hops, 2)]
