"""Speeds against the vehicle's own limits, and its charge against the time that is needed."""

from __future__ import annotations

from collections.abc import Iterator

from jfto_mavlink.preflight.case import Case
from jfto_mavlink.preflight.home import way_home_s
from jfto_mavlink.preflight.page import AMBER, GREEN, RED, Finding

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
    full_s = lasts_s(case)
    if percent is None or not case.aboard.get("BATT_MONITOR", 4.0):
        text = f"needs {time_s:.0f} s with the way home; what is left in its battery is not known"
        yield Finding("battery", AMBER, text, "Set up its battery monitor, or measure by hand.")
        return
    if full_s is not None:
        yield _lasts(case, percent, full_s)
        return
    if percent < settings.battery_min_percent:
        text = f"battery at {percent} %, needs {settings.battery_min_percent} %"
        yield Finding("battery", RED, text, "Charge it.")
        return
    text = f"needs {time_s:.0f} s with the way home; {percent} % left, which nobody can judge"
    yield Finding("battery", AMBER, text, "Give fleet.hover_power_w or fleet.endurance_s.")


def lasts_s(case: Case) -> float | None:
    """How long a full battery flies until it is empty, s; None where nobody says.

    By hover power and capacity where both are known, else by the endurance of the fleet, which
    leaves the reserve out.
    """
    uav, settings = case.mission.uav, case.settings
    hover_w, volts = settings.hover_power_w.get(uav, 0.0), case.now.battery_v
    capacity_ah = case.aboard.get("BATT_CAPACITY") / 1000
    if hover_w > 0 and capacity_ah > 0 and volts:
        return capacity_ah * volts * 3600 / hover_w
    endurance_s = settings.endurance_s.get(uav, 0.0)
    return endurance_s / (1 - settings.battery_reserve_percent / 100) if endurance_s else None


def _lasts(case: Case, percent: int, full_s: float) -> Finding:
    time_s, reserve = needed_s(case), case.settings.battery_reserve_percent
    need = 100 * time_s / full_s
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
