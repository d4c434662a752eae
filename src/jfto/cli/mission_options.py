"""What the commands of `jfto mission` make missions of."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jfto.cli.options import Function, flown_under_option, set_option

if TYPE_CHECKING:
    from jfto_mavlink.mission.build import VehicleMission

_RETURN_HEIGHT = "mavlink_bridge.return_height_m"


def build_options(function: Function) -> Function:
    """How a plan becomes missions: as its scenario's section mavlink_bridge says, or --set."""
    return flown_under_option(set_option(function))


def build(plan_path: Path, choices: Mapping[str, Any]) -> dict[str, VehicleMission]:
    """Missions by UAV of a plan file, as the bridge would upload them."""
    from jfto.planning.scenario_of_plan import load_scenario_for
    from jfto.planning.terrain import known_ground
    from jfto_mavlink.errors import MissionError
    from jfto_mavlink.mission.build import build_missions
    from jfto_mavlink.operation import mission_settings
    from jfto_mavlink.options import BridgeOptions
    from jfto_msgs_py.plan_file import read_plan

    plan = read_plan(plan_path)
    loaded = load_scenario_for(plan_path, choices["scenario"], choices["overrides"])
    options = BridgeOptions(**loaded.node_options.get("mavlink_bridge", {}))
    if plan.homes and any(each.startswith(_RETURN_HEIGHT) for each in choices["overrides"]):
        raise MissionError(
            303,
            f"{plan_path}: its way home is planned and certified, so that {_RETURN_HEIGHT} would "
            "not be flown. Leave it out.",
        )
    dem = known_ground(loaded) if options.check_terrain else None
    settings = mission_settings(plan, options)
    built = build_missions(plan, settings, ground=None if dem is None else dem.height)
    return {mission.uav: mission for mission in built}
