"""Speeds against the vehicle's own limits, and its charge against the time that is needed."""

from __future__ import annotations

from collections.abc import Iterator

from jfto_mavlink.preflight.case import Case
from jfto_mavlink.preflight.home import way_home_s
from jfto_mavlink.preflight.page import AMBER, GREEN, RED, Finding
from jfto_world.motion.battery import HOUR_S, Airborne

_SPEEDS = ("WPNAV_SPEED", "WPNAV_SPEED_UP", "WPNAV_SPEED_DN")
# Rotors spin up and the vehicle disarms.
_AROUND_S = 8.0


def speed(case: Case) -> Iterator[Finding]:
    """Whether the plan flies faster than the vehicle's owner has set."""
    flown = " / ".join(f"{one:g}" for one in case.mission.speeds_mps)
    own = [case.aboard.get(name) / 100 for name in _SPEEDS]
    if not all(own):
        yield Finding("speed", AMBER, f"flown at {flown} m/s; its own limits are not known")
        return
    said = f"flown at {flown} m/s level / up / down"
    over = [
        f"{name} {limit:g} m/s"
        for name, limit, planned in zip(_SPEEDS, own, case.mission.speeds_mps, strict=True)
        if planned > limit * 1.001
    ]
    if not over:
        yield Finding("speed", GREEN, f"{said}, within its own limits")
        return
    told = dict(case.mission.mission.parameters)
    how = "raised for the flight" if any(name in told for name in _SPEEDS) else "flown by order"
    cure = "Make sure that the vehicle may, or plan with slower fleet.*_mps."
    yield Finding("speed", AMBER, f"{said}, above its own {', '.join(over)}: {how}", cure)


def needed_s(case: Case) -> float:
    """From arming until it is down again, s: as planned, or as RTL takes it home."""
    return (case.mission.landed_s or case.mission.ends_s + way_home_s(case)) + _AROUND_S


def battery(case: Case) -> Iterator[Finding]:
    """Whether what is left in the battery lasts for the mission, the way home and a reserve."""
    settings, now = case.settings, case.now
    percent, time_s = now.battery_percent, needed_s(case)
    full = of_a_full_one(case)
    if percent is None or not case.aboard.get("BATT_MONITOR", 4.0):
        text = f"needs {time_s:.0f} s with the way home; what is left in its battery is not known"
        yield Finding("battery", AMBER, text, "Set up its battery monitor, or measure by hand.")
        return
    if full is not None:
        yield _lasts(case, percent, *full)
        return
    if percent < settings.battery_min_percent:
        text = f"battery at {percent} %, needs {settings.battery_min_percent} %"
        yield Finding("battery", RED, text, "Charge it.")
        return
    text = f"needs {time_s:.0f} s with the way home; {percent} % left, which nobody can judge"
    yield Finding("battery", AMBER, text, "Give fleet.hover_power_w or fleet.endurance_s.")


def of_a_full_one(case: Case) -> tuple[float, float] | None:
    """What the flight takes of a full battery, %, and how long a full one flies until it is empty,
    s; None where nobody says.

    By powers and capacity where both are known, the vehicle's own before the plan's; else by the
    endurance of the fleet, which leaves the reserve out.
    """
    uav, settings = case.mission.uav, case.settings
    drain = settings.drains.get(uav)
    if drain is not None:
        aboard_wh = case.aboard.get("BATT_CAPACITY") / 1000 * (case.now.battery_v or 0.0)
        capacity_wh = aboard_wh or drain.battery.capacity_wh
        if capacity_wh > 0:
            share = drain.energy_wh(_flown(case)) / capacity_wh
            return 100 * share, capacity_wh * HOUR_S / drain.greatest_w
    endurance_s = settings.endurance_s.get(uav, 0.0)
    if not endurance_s:
        return None
    full_s = endurance_s / (1 - settings.battery_reserve_percent / 100)
    return 100 * needed_s(case) / full_s, full_s


def _flown(case: Case) -> Airborne:
    """How it spends the time from arming until it is down again."""
    planned = case.settings.flown.get(case.mission.uav)
    if planned is None or not case.mission.landed_s:
        return Airborne(case.mission.ends_s + way_home_s(case), _AROUND_S)
    return Airborne(planned.moving_s, planned.still_s + _AROUND_S)


def _lasts(case: Case, percent: int, need: float, full_s: float) -> Finding:
    time_s, reserve = needed_s(case), case.settings.battery_reserve_percent
    text = (
        f"{percent} % left; needs {need:.0f} % for {time_s:.0f} s with the way home (a full one "
        f"flies {full_s:.0f} s) and {reserve:g} % of reserve"
    )
    if need + reserve <= percent:
        low = case.aboard.get("BATT_LOW_MAH") / max(case.aboard.get("BATT_CAPACITY"), 1.0) * 100
        if case.aboard.get("BATT_FS_LOW_ACT") and percent - need < low:
            text += f"; its failsafe acts at {low:.0f} %, before the end"
            return Finding("battery", AMBER, text, "Charge it, or lower BATT_LOW_MAH.")
        return Finding("battery", GREEN, text)
    cure = "Charge it." if need + reserve <= 100 else "Plan several sorties, or a larger battery."
    return Finding("battery", RED, text, cure)
