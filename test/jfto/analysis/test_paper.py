"""The comparison in words, beside the paper's."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from jfto.analysis.paper import HEADINGS, beside_paper, number, ratios_text
from jfto.pipeline.run import Run


def test_the_papers_figures_stand_beside_ours(tiny_run: tuple[Path, Run]) -> None:
    """For its scenes as it prints them, a dash where it has none; nothing for other scenes."""
    comparison = tiny_run[1].comparison
    assert comparison is not None
    mtp = comparison.results[0]
    cells = dict(zip(HEADINGS, beside_paper(mtp, "small"), strict=True))
    assert cells["ξ (%)"] == (f"{100 * mtp.linked.connectivity_rate:.1f}", "95.0")
    assert cells["Hops"][1] == "inf"
    assert cells["Σ log10(1 + SNR)"] == (f"{mtp.decades:.0f}", "1900")
    wanghai = dict(zip(HEADINGS, beside_paper(mtp, "wanghai"), strict=True))
    assert wanghai["Hops"][1] == "–"
    assert {theirs for _, theirs in beside_paper(mtp, "none")} == {""}


def test_ratios_are_of_throughput_to_c_tops(tiny_run: tuple[Path, Run]) -> None:
    """One per baseline, with the paper's own where it has the scene."""
    comparison = tiny_run[1].comparison
    assert comparison is not None
    ours, mtp = comparison.ours.linked, comparison.results[0].linked
    ratio = ours.mean_throughput_mbps / mtp.mean_throughput_mbps
    assert ratios_text(comparison, "none").startswith(f"{ratio:.2f} × MTP, ")
    assert f"{ratio:.2f} × MTP (paper 1.02)" in ratios_text(comparison, "small")


@pytest.mark.parametrize(
    ("value", "signed", "text"),
    [(1.234, False, "1.23"), (1.234, True, "+1.23"), (None, False, "–"), (math.nan, True, "–"),
     (math.inf, False, "inf"), (-math.inf, False, "-inf")],
)  # fmt: skip
def test_numbers_that_are_none_are_words(value: float | None, signed: bool, text: str) -> None:
    """What is not finite or not known is never printed as nan."""
    assert number(value, 2, signed=signed) == text
