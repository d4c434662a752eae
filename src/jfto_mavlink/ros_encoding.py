"""Fixes and batteries as stock messages. Stamps are ns since the epoch."""

from __future__ import annotations

import math
from typing import Any

from jfto_mavlink.telemetry import BatterySample, FixSample
from jfto_msgs_py.ros.stamps import encode_time


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
