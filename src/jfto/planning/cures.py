"""What would make an infeasible plan possible, tried by short searches."""

from __future__ import annotations

from dataclasses import replace

from jfto.console.progress import SILENT, Progress
from jfto.planning.flight import tightened
from jfto.planning.routes import Planned
from jfto_planner.routing import suggest_cures
from jfto_planner.routing.assess import assess
from jfto_world.terrain import Dem

# No trial begins after so many seconds.
BUDGET_S = 20.0
# What nobody has tried, and may help all the same.
LONGER = "perhaps a longer search (search.moves, search.starts)"


def would_help(planned: Planned, dem: Dem, progress: Progress = SILENT) -> tuple[str, ...]:
    """Changes under which sound routes were found, each with its size; nothing for a clean plan.

    A plan that only breaks rules as it is flown is judged by limits that are drawn in by as much.
    """
    if planned.plan.clean or planned.interrupted:
        return ()
    progress.begin("cures", "trying what would help")
    problem, result = planned.problem, planned.result
    if result.feasible:
        problem = tightened(problem, planned.plan)
        result = replace(result, feasible=False, assessment=assess(problem, result.routes))
    found = suggest_cures(
        problem,
        result,
        seed=planned.plan.seed,
        ground_height=dem.height,
        seconds=BUDGET_S,
        progress=progress.advance,
    )
    progress.end("cures", f"{len(found)} found", "each tried by a short search")
    return (*(cure.text for cure in found), LONGER)
