"""What is to be told of one vehicle, found by comparing two states that follow each other."""

from __future__ import annotations

import math

from jfto_mavlink.flight.telemetry import LinkState
from jfto_msgs_py.records.event import DEBUG, ERROR, INFO, WARN, Event

GPS_FIX_3D = 3
BATTERY_LOW_PERCENT = 25
LEAVING = ("RTL", "SMART_RTL", "LAND")
_LANDED = {1: "on the ground", 2: "in the air", 3: "taking off", 4: "landing"}
# How a vehicle's text begins, the kind of the event, and what to call it.
_CAUSES = (
    ("Battery 1 is", "battery", ""),
    ("EKF Failsafe", "gps", "has lost its position"),
    ("GCS Failsafe", "link", "has lost its station"),
    ("Fence Breached", "fence", "has left its fence"),
    ("Failsafe: Terrain", "failsafe", "has no terrain data"),
)
_DOES = {
    "RTL": "returns home",
    "SMART_RTL": "returns home",
    "LAND": "lands where it is",
    "AUTO": "flies its mission again",
}


def state_changes(before: LinkState, now: LinkState) -> list[Event]:
    """Changes of plain state, at DEBUG: for a log, whoever ordered them."""
    changed = (
        ("link", "heard", math.isinf(before.silent_s) and not math.isinf(now.silent_s)),
        ("mode", f"mode {now.mode}", now.mode != before.mode),
        ("armed", "armed" if now.armed else "disarmed", now.armed != before.armed),
        (
            "landed",
            _LANDED.get(now.landed_state or 0, "unknown"),
            now.landed_state != before.landed_state,
        ),
        (
            "failsafe",
            "failsafe" if now.failsafe else "failsafe over",
            now.failsafe != before.failsafe,
        ),
        (
            "fence",
            "fence breached" if now.fence_breached else "inside the fence",
            now.fence_breached != before.fence_breached,
        ),
        ("reboot", "booted again", now.reboots != before.reboots),
    )
    return [Event(DEBUG, kind, now.uav, text) for kind, text, is_new in changed if is_new]


def troubles_in_flight(before: LinkState, now: LinkState) -> list[Event]:
    """What an operator must learn of a flying vehicle, except who is heard and who has landed.

    The texts say what happened and what the vehicle does about it; they lack their full stop.
    """
    found = [*_mode(before, now), *_gps(before, now), *_battery(before, now)]
    if now.reboots > before.reboots:
        text = "booted again in the air; nothing can be ordered until it is ready"
        found.append(Event(ERROR, "vehicle", now.uav, f"{now.uav} {text}"))
    return found


def place_text(state: LinkState) -> str:
    """Where a vehicle was last heard to be."""
    lat_deg, lon_deg, height_m = state.place
    return f"{lat_deg:.6f} {lon_deg:.6f}, {height_m:.0f} m above its pad"


def _mode(before: LinkState, now: LinkState) -> list[Event]:
    if now.mode == before.mode or now.ordered:
        return []
    kind, reason = _cause(now)
    does = _DOES.get(now.mode, f"is in {now.mode}; order abort to bring it home")
    where = f" at {place_text(now)}" if now.mode == "LAND" else ""
    text = f"{now.uav} {reason}: by itself it {does}{where}"
    return [Event(WARN if now.mode == "AUTO" else ERROR, kind, now.uav, text)]


def _cause(state: LinkState) -> tuple[str, str]:
    for start, kind, words in _CAUSES:
        for text in reversed(state.texts):
            if text.startswith(start):
                # "Battery 1 is low 10.20V used 471 mAh"
                return kind, words or f"says {text[0].lower()}{text[1:]}"
    return "mode", "changed its mode, which nobody ordered here"


def _gps(before: LinkState, now: LinkState) -> list[Event]:
    if before.gps_fix is None or now.gps_fix is None:
        return []
    had, has = before.gps_fix >= GPS_FIX_3D, now.gps_fix >= GPS_FIX_3D
    if had == has:
        return []
    if has:
        return [Event(INFO, "gps", now.uav, f"{now.uav} has its GPS back, in {now.mode}")]
    text = f"has lost its GPS: it flies on in {now.mode} until its own failsafe lands it"
    return [Event(ERROR, "gps", now.uav, f"{now.uav} {text}")]


def _battery(before: LinkState, now: LinkState) -> list[Event]:
    found = []
    told = [text for text in before.texts if text.startswith("Battery 1 is")]
    fresh = [text for text in told if text not in now.texts]
    if fresh and now.mode not in LEAVING:
        # Said long enough ago: its failsafe would have acted by now.
        text = f"says {fresh[-1]}, and no failsafe has acted: it flies on in {now.mode}"
        found.append(Event(ERROR, "battery", now.uav, f"{now.uav} {text}"))
    if before.battery_percent is not None and now.battery_percent is not None:
        low, was = (p < BATTERY_LOW_PERCENT for p in (now.battery_percent, before.battery_percent))
        if low and not was:
            text = f"{now.uav} has {now.battery_percent} % of its battery left and flies on"
            found.append(Event(WARN, "battery", now.uav, text))
    return found
