"""Links to the vehicles that a command line of `jfto mission` names."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jfto.cli.mission_options import is_mission_file
from jfto.cli.options import roster_texts
from jfto_msgs_py.errors import InputError

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    from jfto_mavlink.fleet.link import FleetLink
    from jfto_mavlink.mission.build import VehicleMission


def link_for(
    files: Sequence[Path], missions: Mapping[str, VehicleMission], choices: dict[str, Any]
) -> AbstractContextManager[FleetLink]:
    """Links to the vehicles of a plan, or to those that mission files are for."""
    if not is_mission_file(files[0]):
        return link_fleet(choices, files[0])
    whose = {uav: _whose(uav, files) for uav in missions}
    texts = _with_system_ids(roster_texts(choices["vehicles"]), whose)
    return link_fleet(choices | {"vehicles": tuple(texts)}, uavs=tuple(missions))


def link_fleet(
    choices: dict[str, Any],
    plan_file: Path | None = None,
    *,
    complete: bool = True,
    uavs: tuple[str, ...] = (),
) -> AbstractContextManager[FleetLink]:
    """Links to the vehicles of a command line; simulated ones stand on the pads of the plan."""
    from jfto.flight.fleet_link import Simulated, open_fleet
    from jfto.planning.scenario_file import load_scenario
    from jfto.planning.scenario_of_plan import load_scenario_for
    from jfto.supervision.vehicles import FROM_SCENARIO, named
    from jfto_msgs_py.plan_file import read_plan

    texts: Sequence[str] = roster_texts(choices["vehicles"])
    section: Mapping[str, object] = {}
    if tuple(texts) == (FROM_SCENARIO,):
        if plan_file is not None:
            section = load_scenario_for(plan_file).node_options.get("mavlink_bridge", {})
        elif choices.get("scenario"):
            section = load_scenario(choices["scenario"]).node_options.get("mavlink_bridge", {})
    texts, endpoints = named(texts, section)
    return open_fleet(
        texts,
        None if plan_file is None else read_plan(plan_file),
        simulated=Simulated(choices.get("speedup", 1.0)),
        key_file=choices["key_file"],
        complete=complete,
        uavs=uavs,
        endpoints=endpoints,
    )


def _whose(uav: str, files: Iterable[Path]) -> str:
    """A vehicle for messages, with the file whose name it has where nobody gave another."""
    path = next((path for path in files if path.stem == uav), None)
    return uav if path is None else f"{uav} (the name is that of the file {path.name})"


def _with_system_ids(texts: Sequence[str], uavs: Mapping[str, str]) -> Sequence[str]:
    """Bare links as entries of a roster: uav3 is the vehicle with system id 3, whoever is missing.

    `uavs` are the vehicles with what messages call them. Raises InputError for names that tell no
    system id, or that a roster lacks.
    """
    listed = [text.partition("=")[0] for text in texts if "=" in text]
    lacking = [uav for uav in uavs if uav not in listed]
    if lacking and listed and len(listed) == len(texts):
        raise InputError(
            f"{uavs[lacking[0]]}: --vehicles lists {', '.join(listed)}. Say whose mission the file "
            f"is, as with --uav {listed[0]}."
        )
    if not texts or any("=" in text or ":" not in text or text.startswith("sim") for text in texts):
        return texts
    numbers = {uav: re.fullmatch(r"uav([1-9]\d{0,2})", uav) for uav in uavs}
    odd = [uav for uav, number in numbers.items() if number is None]
    if odd:
        raise InputError(
            f"{uavs[odd[0]]}: nothing says which system id it has. Say whose mission the file is, "
            f"as with --uav uav1, or which vehicle it is: --vehicles {odd[0]}=SYSID@{texts[0]}."
        )
    links = [*texts] * len(numbers) if len(texts) == 1 else [*texts]
    if len(links) != len(numbers):
        raise InputError(
            f"{len(links)} links for {len(numbers)} mission files: give one for all or one each."
        )
    return [f"{uav}={uav[3:]}@{link}" for uav, link in zip(numbers, links, strict=True)]
