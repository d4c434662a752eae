"""Diagnostics of the bridge: what is fine, what an operator should look at."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from jfto_mavlink.telemetry import LinkState
from jfto_mavlink.watch import LOST_AFTER_S
from jfto_msgs_py.ros.diagnostics import ERROR, OK, STALE, WARN, Status


@dataclass(frozen=True)
class Expected:
    """`clock_error_max_s` is a quarter slot; `trouble` and `stream` are words of others."""

    clock_error_max_s: float
    trouble: str = ""
    stream: str = ""


def node_status(note: str, guided: bool, facts: Mapping[str, str]) -> Status:
    """The bridge itself; `note` says why it is not linked, "" if it is."""
    mode = {"flies": "streamed trajectories" if guided else "uploaded missions"}
    if note:
        return Status("", WARN, f"not linked: {note}", {**facts, **mode})
    return Status("", OK, "linked", {**facts, **mode})


def uav_status(uav: str, state: LinkState | None, now_s: float, expected: Expected) -> Status:
    """One vehicle; `now_s` is on the clock of its state."""
    if state is None:
        return Status(uav, STALE, expected.trouble or "not heard yet")
    silent_s = state.silent_s + now_s - state.at_s
    facts = _facts(state, silent_s)
    if expected.stream:
        facts["stream"] = expected.stream
    level, text = _judged(state, silent_s, expected)
    return Status(uav, level, text, facts)


def _judged(state: LinkState, silent_s: float, expected: Expected) -> tuple[int, str]:
    """Level and text: the worst that is to be said."""
    if expected.trouble:
        return ERROR, expected.trouble
    if silent_s > LOST_AFTER_S:
        never = silent_s == float("inf")
        return STALE, "never heard" if never else f"silent for {silent_s:.1f} s"
    if state.failsafe:
        return ERROR, f"failsafe, {state.mode}"
    error_s = state.clock_error_s
    if error_s is None:
        return WARN, "its clock is not compared yet"
    if error_s > expected.clock_error_max_s:
        limit_s = expected.clock_error_max_s
        return WARN, f"its time may be {error_s:.3f} s wrong, a quarter slot is {limit_s:.3f} s"
    text = f"{state.mode}, {'armed' if state.armed else 'disarmed'}"
    if state.waypoint_id is not None:
        text += f", waypoint {state.waypoint_id} {state.late_s or 0.0:+.1f} s"
    return OK, text


def _facts(state: LinkState, silent_s: float) -> dict[str, str]:
    def text(value: float | None, digits: int) -> str:
        return "unknown" if value is None else f"{value:.{digits}f}"

    return {
        "link": "lost" if silent_s > LOST_AFTER_S else "up",
        "silent_s": f"{silent_s:.1f}",
        "mode": state.mode,
        "armed": str(state.armed).lower(),
        "ready_to_arm": str(state.prearm_ok).lower(),
        "clock_offset_s": text(state.offset_s, 6),
        "round_trip_s": text(state.round_trip_s, 6),
        "jitter_s": text(state.jitter_s, 6),
        "utc_error_s": text(state.utc_error_s, 3),
        "reboots": str(state.reboots),
        "waypoints_reached": str(state.reached),
        "last_waypoint": "none" if state.waypoint_id is None else str(state.waypoint_id),
        "late_s": text(state.late_s, 1),
    }
