"""What the commands of `jfto mission` make missions of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jfto.cli.options import Function, flown_under_option, set_option
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.mission_file import PLAN_SUFFIX, WPL_SUFFIXES

if TYPE_CHECKING:
    from jfto_mavlink.mission.build import VehicleMission

_RETURN_HEIGHT = "mavlink_bridge.return_height_m"


def build_options(function: Function) -> Function:
    """How a plan becomes missions: as its scenario's section mavlink_bridge says, or --set."""
    return flown_under_option(set_option(function))


uav_option = click.option(
    "--uav",
    "names",
    multiple=True,
    metavar="UAV",
    help="Whose each mission file is, in the order of the files. Default: the file's name, as uav1 "
    "of uav1.plan.",
)


def build_all(
    files: Sequence[Path], names: Sequence[str], choices: Mapping[str, Any]
) -> dict[str, VehicleMission]:
    """Missions by UAV: of one plan of `jfto plan`, or of mission files, one per vehicle."""
    if not any(is_mission_file(path) for path in files):
        if names or len(files) > 1:
            raise InputError(
                "one plan of jfto plan says itself whose its missions are; --uav and several files "
                "are for .plan and .waypoints files."
            )
        return build(files[0], choices)
    odd = [path for path in files if not is_mission_file(path)]
    if odd:
        raise InputError(f"{odd[0]}: is no .plan or .waypoints file, the others are. Leave it out.")
    uavs = names or [path.stem for path in files]
    if len(uavs) != len(files) or len(set(uavs)) != len(uavs):
        raise InputError(
            f"{len(files)} mission files, for {', '.join(uavs)}: give --uav once for each file, "
            "each another vehicle."
        )
    return _foreign(dict(zip(uavs, files, strict=True)), choices)


def is_mission_file(path: Path) -> bool:
    """Whether a file is a mission of a ground station, not a plan of `jfto plan`."""
    return path.suffix.lower() in (PLAN_SUFFIX, *WPL_SUFFIXES)


def _foreign(files: Mapping[str, Path], choices: Mapping[str, Any]) -> dict[str, VehicleMission]:
    from jfto.flight.foreign_mission import foreign_mission
    from jfto.planning.fence import fence_of
    from jfto.planning.scenario_file import SCENARIO_NAME, load_scenario
    from jfto.planning.terrain import known_ground
    from jfto_mavlink.operation import mission_limits
    from jfto_mavlink.options import BridgeOptions

    beside = next(iter(files.values())).with_name(SCENARIO_NAME)
    scenario = choices["scenario"] or (beside if beside.exists() else None)
    if scenario is None and choices["overrides"]:
        raise InputError("--set changes a scenario, and there is none: give --scenario.")
    loaded = None if scenario is None else load_scenario(scenario, choices["overrides"])
    section = {} if loaded is None else loaded.node_options.get("mavlink_bridge", {})
    options = BridgeOptions(**section)
    dem = known_ground(loaded) if loaded is not None and options.check_terrain else None
    fence = None if loaded is None or dem is None else fence_of(loaded, dem)[0]
    found = {}
    for uav, path in files.items():
        found[uav], notes = foreign_mission(path, uav, mission_limits(options), dem, fence)
        mission = found[uav].mission
        click.echo(
            f"{uav}: {path}, {len(mission.items)} items, {len(mission.fence)} fence, "
            f"{len(mission.rally)} rally points"
        )
        for note in notes:
            click.echo(f"  {note}")
    return found


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
    built = build_missions(plan, settings, ground=None if dem is None else dem.top_height)
    return {mission.uav: mission for mission in built}
