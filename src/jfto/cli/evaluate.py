"""jfto evaluate."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from jfto.cli.options import json_option, load, out_option, print_json, seed_option, set_option

if TYPE_CHECKING:
    from jfto.console.progress import Progress
    from jfto.pipeline.evaluation import Evaluated


@click.command("evaluate")
@click.argument("inputs", metavar="PLAN|SCENARIO...", nargs=-1, required=True)
@out_option("DIR", "not written; CSV, JSON and figures")
@seed_option
@set_option
@json_option
def command(
    inputs: tuple[str, ...],
    out: Path | None,
    seed: int | None,
    overrides: tuple[str, ...],
    as_json: bool,
) -> int:
    """Compare C-TOP with MTP, A-LMST and CPAPO, beside the paper's figures.

    Takes plans (.json) and scenarios, which are planned first. A plan in the directory of a run
    brings its scenario along.

    \b
    Example:  jfto evaluate config/small.yaml config/wanglang.yaml -o comparison
    """
    from jfto.analysis.export import comparison_object
    from jfto.cli.failure import EXIT_INFEASIBLE
    from jfto.cli.results import print_comparison, print_infeasible
    from jfto.console.stages import show_stages
    from jfto.pipeline.evaluation import write_evaluation

    with show_stages(quiet=as_json) as progress:
        done = [_evaluate(Path(name), seed, overrides, progress) for name in inputs]
        if out is not None:
            write_evaluation(done, out, progress)
    rows = [(one.label, one.comparison) for one in done]
    if as_json:
        facts = [comparison_object(one.plan, one.comparison, one.scene) for one in done]
        print_json({"evaluations": facts})
    else:
        print_comparison(rows)
        if out is not None:
            click.echo(f"Written to  {out}")
    unclean = [one for one in done if not one.plan.clean]
    for one in unclean:
        if not as_json:
            print_infeasible(one.plan, "not written; use jfto plan", one.cures)
    return EXIT_INFEASIBLE if unclean else 0


def _evaluate(
    path: Path, seed: int | None, overrides: tuple[str, ...], progress: Progress
) -> Evaluated:
    from jfto.pipeline.evaluation import evaluate_plan_file, evaluate_scenario

    if path.suffix.lower() == ".json":
        if overrides or seed is not None:
            raise click.UsageError(
                f"{path} is a plan; --set and --seed change scenarios only. Plan anew with them."
            )
        return evaluate_plan_file(path, progress)
    return evaluate_scenario(load(path, overrides, seed), progress)
