"""What the node says of its vehicles: fixes and batteries as stock messages, and diagnostics.

Stamps are ns since the epoch.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from jfto_mavlink.flight.telemetry import LOST_AFTER_S, BatterySample, FixSample, LinkState
from jfto_msgs_py.ros.diagnostics import ERROR, OK, STALE, WARN, Status
from jfto_msgs_py.ros.stamps import encode_time


@dataclass(frozen=True)
class Expected:
    """`clock_error_max_s` is a quarter slot, or infinite where the vehicle's clock is the graph's.

    `trouble` and `stream` are words of others.
    """

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
    if expected.trouble:
        facts["trouble"] = expected.trouble
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


def encode_fix(sample: FixSample, stamp_ns: int) -> Any:
    """sensor_msgs/NavSatFix; the frame is the UAV's GPS antenna, taken to be at its body."""
    from sensor_msgs.msg import NavSatFix, NavSatStatus

    message = NavSatFix()
    message.header.stamp = encode_time(stamp_ns)
    message.header.frame_id = sample.uav
    status = NavSatStatus.STATUS_NO_FIX
    if sample.fixed:
        status = NavSatStatus.STATUS_GBAS_FIX if sample.augmented else NavSatStatus.STATUS_FIX
    message.status.status = status
    message.status.service = NavSatStatus.SERVICE_GPS
    message.latitude, message.longitude = sample.lat_deg, sample.lon_deg
    message.altitude = sample.altitude_m
    level, height = sample.horizontal_m, sample.vertical_m
    if math.isfinite(level) and math.isfinite(height):
        # The receiver's horizontal accuracy is of both axes together.
        message.position_covariance = [
            level**2 / 2, 0.0, 0.0, 0.0, level**2 / 2, 0.0, 0.0, 0.0, height**2
        ]  # fmt: skip
        message.position_covariance_type = NavSatFix.COVARIANCE_TYPE_APPROXIMATED
    return message


def encode_battery(sample: BatterySample, stamp_ns: int) -> Any:
    """sensor_msgs/BatteryState; the current is negative while it discharges."""
    from sensor_msgs.msg import BatteryState

    message = BatteryState()
    message.header.stamp = encode_time(stamp_ns)
    message.header.frame_id = sample.uav
    message.voltage = sample.voltage_v
    message.current = -sample.current_a
    message.percentage = sample.share
    for unknown in ("temperature", "charge", "capacity", "design_capacity"):
        setattr(message, unknown, math.nan)
    message.power_supply_status = BatteryState.POWER_SUPPLY_STATUS_DISCHARGING
    message.power_supply_technology = BatteryState.POWER_SUPPLY_TECHNOLOGY_LIPO
    message.present = math.isfinite(sample.voltage_v)
    return message
