"""The run of one sortie of several, with what earlier ones left undone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from jfto.console.progress import SILENT, Progress
from jfto.pipeline.run import Pipeline, Run
from jfto.pipeline.sorties import left_over, sortie_directory
from jfto.planning.fence import fence_of
from jfto.planning.routes import plan_routes
from jfto.planning.scenario_file import LoadedScenario
from jfto.planning.survey import Survey
from jfto.planning.terrain import load_ground
from jfto_msgs_py.errors import InfeasibleError, InputError
from jfto_msgs_py.plan_file import read_plan
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.records.site import Sortie


def with_left_over(
    loaded: LoadedScenario,
    directory: Path,
    plans: tuple[Plan, ...],
    number: int,
    progress: Progress = SILENT,
) -> Plan:
    """The plan of a sortie, made anew with what earlier ones left where there is such.

    One sortie more than there are plans takes what all of them left. Where not all of it fits, the
    plan stays as it is and the rest waits; both are told. Raises InfeasibleError, InputError.
    """
    left, more = left_over(directory, number), number > len(plans)
    waypoints = tuple(waypoint for some in left.values() for waypoint in some)
    if number > len(plans) + 1 or (more and not waypoints):
        raise InputError(
            f"--sortie {number}: there {'are' if len(plans) > 1 else 'is'} {len(plans)}"
            f"{'' if number > len(plans) + 1 else ', and none has left a waypoint'}. "
            f"Give 1 to {len(plans)}."
        )
    sortie = Sortie(number, max(number, len(plans)))
    own = None if more else plans[number - 1]
    if not waypoints and own is not None:
        return replace(own, sortie=sortie)
    said = f"{_counted(len(waypoints))} left by sortie {' and '.join(map(str, left))}"
    like = own or plans[-1]
    pads = np.array([uav.start_m[:2] for uav in like.uavs])
    before = () if own is None else tuple(w for w in own.waypoints if w.photo)
    dem = load_ground(loaded)
    fence, _ = fence_of(loaded, dem)
    found = Survey(dem, before + waypoints, None, starts_m=pads, fence=fence)
    try:
        planned = plan_routes(loaded.scenario, found, progress)
    except InfeasibleError:
        if own is None:
            raise
        planned = None
    if planned is not None and planned.interrupted:
        raise KeyboardInterrupt
    if own is not None and (planned is None or not planned.plan.clean):
        progress.warn(f"{said} did not fit into this sortie, wait for --sortie {number + 1}.")
        return replace(own, sortie=sortie)
    assert planned is not None
    progress.end("left over", f"{len(waypoints)} waypoints", f"{said} added")
    return replace(planned.plan, sortie=sortie)


def sortie_run(
    loaded: LoadedScenario, directory: Path, planned: Run, number: int, progress: Progress = SILENT
) -> tuple[Pipeline, Run]:
    """The run of one sortie, in a directory of its own below that of the whole one.

    Its plan has what earlier sorties left. Raises InputError where there is no such sortie.
    """
    plans = tuple(read_plan(file) for file in planned.sorties) or (planned.plan,)
    plan = with_left_over(loaded, directory, plans, number, progress)
    pipeline = Pipeline(loaded, sortie_directory(directory, number), progress)
    return pipeline, pipeline.keep(plan)


def report_others(
    loaded: LoadedScenario, directory: Path, planned: Run, number: int, progress: Progress = SILENT
) -> None:
    """Figures and report of every sortie but one, as planned."""
    for other in range(1, len(planned.sorties) + 1):
        if other != number:
            pipeline, run = sortie_run(loaded, directory, planned, other, progress)
            pipeline.report(run)


def _counted(waypoints: int) -> str:
    return f"{waypoints} waypoint{'s' * (waypoints > 1)}"
