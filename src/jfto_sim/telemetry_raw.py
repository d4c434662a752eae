"""Messages about sensors and servos: plausible, still values in the recorded form."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from jfto_sim.dialect import Message, mavlink

if TYPE_CHECKING:
    from jfto_sim.vehicle import Vehicle

_SEA_LEVEL_HPA, _SCALE_M = 1013.25, 8434.0
_MAG = (217, 12, 429)
_BOARD_TEMPERATURE = 2847


def _pressure_hpa(v: Vehicle) -> float:
    return _SEA_LEVEL_HPA * math.exp(-v.reported_position()[2] / _SCALE_M)


def raw_imu(v: Vehicle) -> Message:
    """RAW_IMU at rest."""
    return mavlink.MAVLink_raw_imu_message(
        v.time_us, 0, 0, -1000, 0, 0, 0, *_MAG, 0, _BOARD_TEMPERATURE
    )


def scaled_imu2(v: Vehicle) -> Message:
    """SCALED_IMU2 at rest."""
    return mavlink.MAVLink_scaled_imu2_message(
        v.time_ms, 0, 0, -1000, 0, 0, 0, *_MAG, _BOARD_TEMPERATURE
    )


def scaled_imu3(v: Vehicle) -> Message:
    """SCALED_IMU3: compass only."""
    return mavlink.MAVLink_scaled_imu3_message(v.time_ms, 0, 0, 0, 0, 0, 0, *_MAG, 0)


def scaled_pressure(v: Vehicle) -> Message:
    """SCALED_PRESSURE at the present height."""
    return mavlink.MAVLink_scaled_pressure_message(v.time_ms, _pressure_hpa(v), 0.0, 3086)


def scaled_pressure2(v: Vehicle) -> Message:
    """SCALED_PRESSURE2 at the present height."""
    return mavlink.MAVLink_scaled_pressure2_message(v.time_ms, _pressure_hpa(v), 0.0, 3086)


def power_status(_: Vehicle) -> Message:
    """POWER_STATUS."""
    return mavlink.MAVLink_power_status_message(5000, 0, 0)


def meminfo(_: Vehicle) -> Message:
    """MEMINFO."""
    return mavlink.MAVLink_meminfo_message(0, 65535, 131072)


def servo_output_raw(v: Vehicle) -> Message:
    """SERVO_OUTPUT_RAW: four motors."""
    speed = 1500 if v.arming.armed and not v.body.landed else 1000
    return mavlink.MAVLink_servo_output_raw_message(
        v.time_us & 0xFFFFFFFF, 0, *([speed] * 4), *([0] * 4)
    )


def rc_channels(v: Vehicle) -> Message:
    """RC_CHANNELS: sticks at rest, throttle down."""
    sticks = [1500, 1500, 1000, 1500, 1800, 1000, 1000, 1800]
    return mavlink.MAVLink_rc_channels_message(v.time_ms, 16, *sticks, *([0] * 10), 255)


def ahrs(_: Vehicle) -> Message:
    """AHRS."""
    return mavlink.MAVLink_ahrs_message(0.0, 0.0, 0.0, 0.0, 0.0, 0.0025, 0.0024)


def ahrs2(v: Vehicle) -> Message:
    """AHRS2."""
    roll, pitch = v.body.attitude_deg
    lat, lon, alt_m = v.reported_position()
    yaw = math.radians((v.body.yaw_deg + 180.0) % 360.0 - 180.0)
    return mavlink.MAVLink_ahrs2_message(
        math.radians(roll), math.radians(pitch), yaw, alt_m, lat, lon
    )


def simstate(v: Vehicle) -> Message:
    """SIMSTATE: the simulator's own truth, without noise."""
    roll, pitch = v.body.attitude_deg
    lat, lon = v.place()
    yaw = math.radians((v.body.yaw_deg + 180.0) % 360.0 - 180.0)
    return mavlink.MAVLink_simstate_message(
        math.radians(roll), math.radians(pitch), yaw, 0.0, 0.0, -9.80665, 0.0, 0.0, 0.0, lat, lon
    )


def wind(v: Vehicle) -> Message:
    """WIND: where it comes from."""
    east, north = v.wind_mps
    speed = math.hypot(east, north)
    direction = math.degrees(math.atan2(-east, -north)) if speed > 0 else -180.0
    return mavlink.MAVLink_wind_message(direction, speed, 0.0)


def terrain_report(v: Vehicle) -> Message:
    """TERRAIN_REPORT: nothing is loaded."""
    lat, lon, alt_m = v.reported_position()
    return mavlink.MAVLink_terrain_report_message(lat, lon, 0, 0.0, alt_m, 504, 0)


def terrain_request(v: Vehicle) -> Message:
    """TERRAIN_REQUEST for the block around home."""
    lat, lon = v.origin
    return mavlink.MAVLink_terrain_request_message(lat - 96676, lon - 273711, 100, 2**56 - 1)


def vibration(v: Vehicle) -> Message:
    """VIBRATION."""
    return mavlink.MAVLink_vibration_message(v.time_us, 0.003, 0.003, 0.003, 0, 0, 0)


def esc_telemetry(v: Vehicle) -> Message:
    """ESC_TELEMETRY_1_TO_4."""
    count = int(v.time_s * 400) & 0xFFFF
    return mavlink.MAVLink_esc_telemetry_1_to_4_message(
        [32] * 4, [1679] * 4, [80] * 4, [1] * 4, [0] * 4, [count] * 4
    )
