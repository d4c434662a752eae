"""jfto run."""

from __future__ import annotations

from pathlib import Path

import click

from jfto.cli.options import (
    debug_option,
    json_option,
    load,
    out_option,
    scenario_argument,
    seed_option,
    set_option,
)


@click.command("run")
@scenario_argument
@out_option("DIR", "run-<UTC time>")
@seed_option
@set_option
@json_option
@debug_option
def command(
    scenario: Path,
    out: Path | None,
    seed: int | None,
    overrides: tuple[str, ...],
    as_json: bool,
    debug: bool,  # noqa: ARG001  main() reads it
) -> int:
    """Plan, verify and compare SCENARIO, and write a report.

    Coverage, routes, topology, power, comparison with MTP, A-LMST and CPAPO, figures, report: all
    results go to one directory. An infeasible scenario ends with status 3; the closest plan and a
    report of what is violated are kept.

    \b
    Example:  jfto run config/demo.yaml --seed 1 --set fleet.speed_mps=9
    """
    loaded = load(scenario, overrides, seed)

    from jfto.cli.failure import EXIT_INFEASIBLE, EXIT_INTERRUPTED
    from jfto.cli.summary import plan_facts, print_comparison, print_infeasible, print_json
    from jfto.cli.watcher import TerminalWatcher
    from jfto.export import comparison_object
    from jfto.pipeline import run_all
    from jfto.run_directory import make_run_directory, what_is_kept
    from jfto.stages.routes import is_clean

    directory = make_run_directory(out)
    fleet, area = loaded.scenario.fleet, loaded.scenario.terrain.size_m
    with TerminalWatcher(quiet=as_json) as watcher:
        watcher.console.print(
            f"Scenario    {scenario}   {fleet.count} UAVs, {area[0] / 1000:g} × "
            f"{area[1] / 1000:g} km, {loaded.scenario.terrain.source}",
            markup=False,
        )
        try:
            outcome = run_all(loaded, directory, watcher)
        except KeyboardInterrupt:
            outcome = None
    if outcome is None or outcome.comparison is None:
        click.echo(f"Interrupted. {what_is_kept(directory)}", err=True)
        return EXIT_INTERRUPTED
    path = str(outcome.plan_path)
    if as_json:
        scene = loaded.scenario.evaluation.paper_scene
        facts = plan_facts(outcome.plan, path)
        facts["comparison"] = comparison_object(outcome.plan, outcome.comparison, scene)
        facts["report"] = str(outcome.report)
        print_json(facts)
    else:
        print_comparison([(_scene(loaded.scenario.evaluation.paper_scene), outcome.comparison)])
    if not is_clean(outcome.plan):
        if not as_json:
            print_infeasible(outcome.plan, path)
            click.echo(f"Report      {outcome.report}")
        return EXIT_INFEASIBLE
    if not as_json:
        click.echo(f"Report      {outcome.report}")
    return 0


def _scene(paper_scene: str) -> str:
    return "this scene" if paper_scene == "none" else paper_scene
