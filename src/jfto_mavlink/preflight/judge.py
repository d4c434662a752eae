"""All checks in one table, and the page that comes of them. Knows no link and no clock."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping

from jfto_mavlink.mission.build import VehicleMission
from jfto_mavlink.preflight.case import Case
from jfto_mavlink.preflight.endurance import battery, speed
from jfto_mavlink.preflight.facts import Surveyed
from jfto_mavlink.preflight.failsafe import failsafe
from jfto_mavlink.preflight.fence import fence
from jfto_mavlink.preflight.home import home
from jfto_mavlink.preflight.pads import pads
from jfto_mavlink.preflight.page import (
    GREEN,
    RED,
    TOPICS,
    Change,
    Finding,
    Preflight,
    VehiclePage,
)
from jfto_mavlink.preflight.ready import on_board, ready, wind
from jfto_mavlink.preflight.settings import GateSettings
from jfto_mavlink.protocol.parameter import equal

Check = Callable[[Case], Iterable[Finding]]
_LINK = "Switch it on; compare the address, its SYSID_THISMAV and its baud rate with --vehicles."


def changes(case: Case) -> tuple[Change, ...]:
    """What the mission sets and the vehicle has otherwise."""
    return tuple(
        Change(name, case.aboard.parameters[name], value)
        for name, value in case.mission.mission.parameters
        if name in case.aboard.parameters and not equal(case.aboard.parameters[name], value)
    )


def parameters(case: Case) -> Iterable[Finding]:
    """What is set for the flight and put back after it; what the firmware does not know."""
    wanted = [name for name, _ in case.mission.mission.parameters]
    unknown = [name for name in wanted if name not in case.aboard.parameters]
    if unknown:
        text = f"its firmware does not know {', '.join(unknown)}"
        yield Finding("parameters", RED, text, "The plan's times rely on them: use ArduCopter 4.5.")
    found = changes(case)
    text = ", ".join(map(str, found))
    said = f"{len(found)} are set for the flight and put back after it: {text}"
    yield Finding("parameters", GREEN, said if found else "nothing is changed")


CHECKS: tuple[Check, ...] = (
    *(ready, on_board, fence, speed, home, battery, wind, failsafe, parameters),
)


def judge(
    missions: Mapping[str, VehicleMission],
    found: Mapping[str, Surveyed | Exception],
    settings: GateSettings,
) -> Preflight:
    """The page of a fleet: a vehicle of which nothing could be found out has the error on it."""
    homes = {uav: mission.home_deg_m for uav, mission in missions.items()}
    places = {u: one.now.place if isinstance(one, Surveyed) else None for u, one in found.items()}
    on_pads = pads(homes, places, settings.pad_distance_max_m)
    pages = []
    for uav, mission in missions.items():
        one = found[uav]
        if not isinstance(one, Surveyed):
            text = str(one).removeprefix(f"{uav}: ")
            pages.append(VehiclePage(uav, (Finding("identity", RED, text),)))
            continue
        if math.isinf(one.now.silent_s) and not one.aboard.parameters:
            # Nothing it could be judged by was ever received: each other line would be a guess.
            pages.append(
                VehiclePage(uav, (Finding("identity", RED, "not heard on its link", _LINK),))
            )
            continue
        case = Case(mission, one.now, one.aboard, settings)
        who = "signed" if one.now.signed else "unsigned"
        findings = [Finding("identity", GREEN, f"one vehicle answers, {who}"), *on_pads[uav]]
        for check in CHECKS:
            findings += check(case)
        findings.sort(key=lambda each: list(TOPICS).index(each.topic))
        pages.append(VehiclePage(uav, tuple(findings), changes(case)))
    return Preflight(tuple(pages))
