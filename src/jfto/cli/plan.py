"""jfto plan."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from jfto.cli.options import PATH, json_option, out_option, print_json, scenario_options

if TYPE_CHECKING:
    from jfto.planning.scenario_file import LoadedScenario


@click.command("plan")
@scenario_options()
@out_option("FILE", "plan.json")
@click.option("--warm-start", type=PATH, metavar="PLAN", help="Improve this plan.")
@json_option
def command(
    loaded: LoadedScenario, out: Path | None, warm_start: Path | None, as_json: bool
) -> int:
    """Plan the routes of SCENARIO and write a verified plan.

    Where one flight does not do, FILE-1.json, FILE-2.json and so on are plans of several sorties.
    The same scenario and seed give the same bytes. An infeasible scenario ends with status 3 and
    the closest plan of one flight, if there is one, in FILE's .infeasible.json. Ctrl-C keeps the
    best plan so far.

    \b
    Example:  jfto plan config/wanglang.yaml -o plan.json --seed 1
    """
    from jfto import words
    from jfto.cli.failure import EXIT_INFEASIBLE, EXIT_INTERRUPTED
    from jfto.cli.results import plan_facts, print_infeasible
    from jfto.console.stages import show_stages
    from jfto.pipeline.run import save_plans
    from jfto.pipeline.sorties import stale_sorties
    from jfto.planning.cures import would_help
    from jfto.planning.sorties import plan_sorties
    from jfto.planning.survey import survey
    from jfto_msgs_py.plan_file import read_plan

    earlier = None if warm_start is None else read_plan(warm_start)
    with show_stages(quiet=as_json) as progress:
        found = survey(loaded, progress)
        sorties = plan_sorties(loaded.scenario, found, progress, warm_start=earlier)
        planned = sorties.sorties[0]
        cures = would_help(planned, found.dem, progress)
    target = out or Path("plan.json")
    clean = all(plan.clean for plan in sorties.plans)
    stale = stale_sorties(target, sorties.plans) if clean else ()
    paths = save_plans(sorties.plans, target)
    path = paths[0]
    if as_json:
        learned = {"learned": planned.learned} if planned.learned else {}
        facts = [plan_facts(p, str(at), cures) for p, at in zip(sorties.plans, paths, strict=True)]
        several = {"sorties": facts, "least": sorties.least} if len(facts) > 1 else {}
        print_json(facts[0] | learned | several)
    if not planned.plan.clean:
        if not as_json:
            print_infeasible(planned.plan, str(path), cures)
        return EXIT_INTERRUPTED if planned.interrupted else EXIT_INFEASIBLE
    if planned.interrupted:
        kept = ", ".join(map(str, paths))
        click.echo(f"Interrupted. The best plan so far is kept and verified: {kept}", err=True)
        return EXIT_INTERRUPTED
    if not as_json:
        if len(paths) > 1:
            click.echo(f"Sorties     {words.sorties(sorties.plans, sorties.least)}")
        for each in paths:
            click.echo(f"Plan        {each}")
        if stale:
            click.echo(f"Removed     {', '.join(map(str, stale))} (of an earlier division)")
    return 0
