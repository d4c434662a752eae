"""jfto plan."""

from __future__ import annotations

from pathlib import Path

import click

from jfto.cli.options import (
    debug_option,
    json_option,
    load,
    method_option,
    out_option,
    scenario_argument,
    seed_option,
    set_option,
)


@click.command("plan")
@scenario_argument
@out_option("FILE", "plan.json")
@click.option(
    "--warm-start", type=click.Path(path_type=Path), metavar="PLAN", help="Improve this plan."
)
@method_option
@seed_option
@set_option
@json_option
@debug_option
def command(
    scenario: Path,
    out: Path | None,
    warm_start: Path | None,
    method: str | None,
    seed: int | None,
    overrides: tuple[str, ...],
    as_json: bool,
    debug: bool,  # noqa: ARG001  main() reads it
) -> int:
    """Plan the routes of SCENARIO and write a verified plan.

    The same scenario and seed give the same bytes. An infeasible scenario ends with status 3 and
    the closest plan in FILE's .infeasible.json. Ctrl-C keeps the best plan so far.

    \b
    Example:  jfto plan config/wanglang.yaml -o plan.json --seed 1
    """
    loaded = load(scenario, overrides, seed, method)

    from jfto.cli.failure import EXIT_INFEASIBLE, EXIT_INTERRUPTED
    from jfto.console.summary import plan_facts, print_infeasible, print_json
    from jfto.console.watcher import TerminalWatcher
    from jfto.pipeline.run import save_plan
    from jfto.planning.routes import is_clean, plan_routes
    from jfto.planning.survey import survey
    from jfto_msgs_py.plan_file import read_plan

    earlier = None if warm_start is None else read_plan(warm_start)
    with TerminalWatcher(quiet=as_json) as watcher:
        found = survey(loaded, watcher)
        planned = plan_routes(loaded.scenario, found, watcher, warm_start=earlier)
    path = save_plan(planned.plan, out or Path("plan.json"))
    if as_json:
        learned = {"learned": planned.learned} if planned.learned else {}
        print_json(plan_facts(planned.plan, str(path)) | learned)
    if not is_clean(planned.plan):
        if not as_json:
            print_infeasible(planned.plan, str(path))
        return EXIT_INTERRUPTED if planned.interrupted else EXIT_INFEASIBLE
    if planned.interrupted:
        click.echo(f"Interrupted. The best plan so far is kept and verified: {path}", err=True)
        return EXIT_INTERRUPTED
    if not as_json:
        click.echo(f"Plan        {path}")
    return 0
