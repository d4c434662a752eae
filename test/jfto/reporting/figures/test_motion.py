"""The figure of flights."""

from __future__ import annotations

from dataclasses import replace

import pytest

from jfto.planning.survey import Survey
from jfto.reporting.figures.motion import flight_profiles
from jfto.reporting.palette import uav_colour
from jfto_msgs_py.records.plan import Plan


@pytest.mark.parametrize(("model", "columns"), [("bezier", 4), ("constant_speed", 2)])
def test_every_uav_has_a_row_in_its_colour(
    tiny_survey: Survey, tiny_guided: Plan, model: str, columns: int
) -> None:
    """One panel per UAV and quantity; acceleration and jerk only where speed does not jump."""
    plan = tiny_guided
    if model != "bezier":
        plan = replace(plan, time_model=model, time_parameters={}, trajectories=())
    axes = flight_profiles(plan, tiny_survey.dem).axes
    assert len(axes) == columns * len(plan.uavs)
    colours = [axes[columns * row].lines[0].get_color() for row in range(len(plan.uavs))]
    assert colours == [uav_colour(row) for row in range(len(plan.uavs))]
