"""Options that the commands of `jfto mission` share, and what they read with them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jfto.cli.options import PATH, Function

if TYPE_CHECKING:
    from jfto_mavlink.mission.build import VehicleMission


def build_options(function: Function) -> Function:
    """Choices of how a plan becomes missions."""
    for option in reversed(
        (
            click.option(
                "--style",
                type=click.Choice(["fly_through", "hold"]),
                help="hold stops 1 s at each waypoint: sharper photos, about 6 s longer each. "
                "Default: as planned.",
            ),
            click.option(
                "--within",
                type=click.FloatRange(0.1, 10.0),
                default=2.0,
                show_default=True,
                metavar="M",
                help="How close every waypoint is passed; less is slower at corners.",
            ),
            click.option(
                "--takeoff-height",
                type=float,
                metavar="M",
                help="Default: as planned, 10 m where the plan does not say.",
            ),
            click.option(
                "--return-height",
                type=float,
                metavar="M",
                help="Climb to this height above home before returning, if lower.",
            ),
            click.option(
                "--height-min",
                type=float,
                default=0.0,
                show_default=True,
                metavar="M",
                help="Least height above home, where the terrain is not known.",
            ),
            click.option(
                "--terrain",
                type=PATH,
                metavar="SCENARIO",
                help="Scenario whose terrain the legs and the way home must clear. Default: "
                "scenario.yaml beside the plan, if there is one.",
            ),
            click.option(
                "--height-max", type=float, default=1000.0, show_default=True, metavar="M"
            ),
            click.option(
                "--distance-max", type=float, default=5000.0, show_default=True, metavar="M"
            ),
        )
    ):
        function = option(function)
    return function


def build(plan_path: Path, choices: Mapping[str, Any]) -> dict[str, VehicleMission]:
    """Missions by UAV of a plan file from the values of `build_options`."""
    from jfto.planning.scenario_file import SCENARIO_NAME, load_scenario
    from jfto.planning.terrain import known_ground
    from jfto_mavlink.errors import MissionError
    from jfto_mavlink.mission.build import build_missions
    from jfto_mavlink.mission.limits import MissionLimits
    from jfto_mavlink.mission.settings import settings_for
    from jfto_msgs_py.plan_file import read_plan

    plan = read_plan(plan_path)
    if plan.homes and choices["return_height"] is not None:
        raise MissionError(
            303,
            f"{plan_path}: its way home is planned and certified, so that --return-height would "
            "not be flown. Leave it out.",
        )
    beside = plan_path.with_name(SCENARIO_NAME)
    scenario = choices["terrain"] or (beside if beside.exists() else None)
    dem = None if scenario is None else known_ground(load_scenario(scenario))
    limits = MissionLimits(
        height_min_m=choices["height_min"],
        height_max_m=choices["height_max"],
        distance_max_m=choices["distance_max"],
    )
    settings = settings_for(
        plan,
        style=choices["style"],
        pass_within_m=choices["within"],
        takeoff_height_m=choices["takeoff_height"],
        return_height_m=choices["return_height"],
        limits=limits,
    )
    built = build_missions(plan, settings, ground=None if dem is None else dem.height)
    return {mission.uav: mission for mission in built}
