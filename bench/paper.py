"""The paper's comparison on its four scenes over several plans each, beside its own figures.

Every plan is another search (seed); medians, with the least and the greatest in brackets.

    python bench/paper.py [--seeds 5] [--scenes wanglang small] [-o bench-paper]
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np

import jfto
from jfto.analysis.comparison import FORM_NAMES, Comparison
from jfto.analysis.paper import PAPER, paper_row
from jfto_msgs_py.plan_file import read_plan, write_plan
from jfto_msgs_py.records.plan import Plan

CONFIG = Path(__file__).parents[1] / "config"
SCENES = ("wanglang", "small", "wanglang_gaussian", "wanghai")
ELASTIC = FORM_NAMES["elastic"]


def planned(scene: str, seed: int, directory: Path) -> Plan:
    """The plan of a scene and seed, from its file where an earlier run made it for this scene."""
    scenario = jfto.load_scenario(CONFIG / f"{scene}.yaml")
    path = directory / f"{scene}-{seed}.json"
    if path.exists():
        plan = read_plan(path)
        if plan.scenario_hash == scenario.scenario.scenario_hash():
            return plan
    plan = jfto.plan(scenario, seed=seed)
    write_plan(plan, path)
    return plan


def figures(plan: Plan, comparison: Comparison) -> dict[str, dict[str, float]]:
    """What each algorithm makes of a plan."""
    most, found = plan.k_min + plan.delta, {}
    for result in comparison.results:
        within = (result.degree >= plan.k_min) & (result.degree <= most)
        found[result.name] = {
            "decades": result.decades,
            "mbps": result.linked.mean_throughput_mbps,
            "listed_mbps": result.active.mean_throughput_mbps,
            "xi": 100 * result.linked.connectivity_rate,
            "hops": result.linked.hops,
            "listed": float(result.degree.mean()),
            "heard": float(result.heard.mean()),
            "within": 100 * float(within.mean()),
            "energy_j": float(result.energy_j.sum()),
            "all_fly": float(result.traverses_all),
        }
    return found


def spread(values: list[float], digits: int) -> str:
    """Median, and in brackets the least and the greatest where they differ."""
    low, middle, high = (f"{v:.{digits}f}" for v in (min(values), np.median(values), max(values)))
    return middle if low == high else f"{middle} ({low}–{high})"


def table(scene: str, runs: list[dict[str, dict[str, float]]]) -> str:
    """Markdown of one scene: the figures, then ratios to the baselines beside the paper's."""
    columns = (("decades", 0), ("mbps", 0), ("listed_mbps", 0), ("xi", 1), ("hops", 2))
    more = (("listed", 2), ("heard", 2), ("within", 1), ("energy_j", 0))
    lines = [
        f"### {scene}, {len(runs)} plans",
        "",
        (
            "| | paper | Σ log10(1 + SNR) | Mb/s heard | Mb/s listed | ξ % | hops | listed | heard "
            "| K_min…K_min+δ % | J | all fly |"
        ),
        "|---" * 12 + "|",
    ]
    for name in runs[0]:
        theirs = paper_row(scene, name)
        cells = [
            spread([run[name][key] for run in runs], digits) for key, digits in (*columns, *more)
        ]
        flew = f"{sum(run[name]['all_fly'] for run in runs):.0f} of {len(runs)}"
        paper = "" if theirs is None else f"{theirs.throughput:.0f}"
        lines.append(f"| {name} | {paper} | " + " | ".join([*cells, flew]) + " |")
    lines += [
        "",
        "| throughput over | paper | literal | closed | elastic |",
        "|---|---|---|---|---|",
    ]
    theirs = PAPER[scene]
    for baseline in ("MTP", "A-LMST", "CPAPO"):
        cells = [
            spread([run[name]["mbps"] / run[baseline]["mbps"] for run in runs], 2)
            for name in FORM_NAMES.values()
        ]
        order = dict(zip(FORM_NAMES, cells, strict=True))
        paper = theirs["C-TOP"].throughput / theirs[baseline].throughput
        row = [order[form] for form in ("literal", "closed", "elastic")]
        lines.append(f"| {baseline} | {paper:.2f} | " + " | ".join(row) + " |")
    return "\n".join([*lines, ""])


def main() -> None:
    """Plan what is not planned yet, compare, print a table for each scene."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=SCENES)
    parser.add_argument("-o", "--out", type=Path, default=Path("bench-paper"))
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    kept = {}
    for scene in given.scenes:
        n_dc = jfto.load_scenario(CONFIG / f"{scene}.yaml").scenario.evaluation.n_dc
        runs = []
        for seed in range(given.seeds):
            plan = planned(scene, seed, given.out)
            runs.append(figures(plan, jfto.compare(plan, n_dc=n_dc)))
        kept[scene] = runs
        print(table(scene, runs), flush=True)
    (given.out / "figures.json").write_text(json.dumps(kept, indent=1))


if __name__ == "__main__":
    main()
