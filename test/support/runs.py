"""Runs of a scenario without a flight."""

from __future__ import annotations

from pathlib import Path

from jfto.console.progress import SILENT, Progress
from jfto.pipeline.run import Pipeline, Run
from jfto.planning.scenario_file import LoadedScenario


def run_all(loaded: LoadedScenario, directory: Path, progress: Progress = SILENT) -> Run:
    """Every stage, from terrain to report."""
    pipeline = Pipeline(loaded, directory, progress)
    return pipeline.report(pipeline.plan())
