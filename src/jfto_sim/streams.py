"""What goes out regularly: which messages a stream holds, and which may be asked for at all."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from jfto_sim import telemetry, telemetry_raw
from jfto_sim.dialect import Message, mavlink

if TYPE_CHECKING:
    from jfto_sim.vehicle import Vehicle

Builder = Callable[["Vehicle"], Message]

BUILDERS: dict[int, Builder] = {
    mavlink.MAVLINK_MSG_ID_HEARTBEAT: telemetry.heartbeat,
    mavlink.MAVLINK_MSG_ID_SYS_STATUS: telemetry.sys_status,
    mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: telemetry.system_time,
    mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: telemetry.gps_raw_int,
    mavlink.MAVLINK_MSG_ID_ATTITUDE: telemetry.attitude,
    mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED: telemetry.local_position_ned,
    mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: telemetry.global_position_int,
    mavlink.MAVLINK_MSG_ID_MISSION_CURRENT: telemetry.mission_current,
    mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT: telemetry.nav_controller_output,
    mavlink.MAVLINK_MSG_ID_VFR_HUD: telemetry.vfr_hud,
    mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: telemetry.battery_status,
    mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION: telemetry.autopilot_version,
    mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: telemetry.extended_sys_state,
    mavlink.MAVLINK_MSG_ID_HOME_POSITION: telemetry.home_position,
    mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN: telemetry.gps_global_origin,
    mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT: telemetry.ekf_status_report,
    mavlink.MAVLINK_MSG_ID_FENCE_STATUS: telemetry.fence_status,
    mavlink.MAVLINK_MSG_ID_RAW_IMU: telemetry_raw.raw_imu,
    mavlink.MAVLINK_MSG_ID_SCALED_IMU2: telemetry_raw.scaled_imu2,
    mavlink.MAVLINK_MSG_ID_SCALED_IMU3: telemetry_raw.scaled_imu3,
    mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE: telemetry_raw.scaled_pressure,
    mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE2: telemetry_raw.scaled_pressure2,
    mavlink.MAVLINK_MSG_ID_POWER_STATUS: telemetry_raw.power_status,
    mavlink.MAVLINK_MSG_ID_MEMINFO: telemetry_raw.meminfo,
    mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW: telemetry_raw.servo_output_raw,
    mavlink.MAVLINK_MSG_ID_RC_CHANNELS: telemetry_raw.rc_channels,
    mavlink.MAVLINK_MSG_ID_AHRS: telemetry_raw.ahrs,
    mavlink.MAVLINK_MSG_ID_AHRS2: telemetry_raw.ahrs2,
    mavlink.MAVLINK_MSG_ID_SIMSTATE: telemetry_raw.simstate,
    mavlink.MAVLINK_MSG_ID_WIND: telemetry_raw.wind,
    mavlink.MAVLINK_MSG_ID_TERRAIN_REPORT: telemetry_raw.terrain_report,
    mavlink.MAVLINK_MSG_ID_TERRAIN_REQUEST: telemetry_raw.terrain_request,
    mavlink.MAVLINK_MSG_ID_VIBRATION: telemetry_raw.vibration,
    mavlink.MAVLINK_MSG_ID_ESC_TELEMETRY_1_TO_4: telemetry_raw.esc_telemetry,
    mavlink.MAVLINK_MSG_ID_TIMESYNC: telemetry.timesync,
}
KNOWN = frozenset(BUILDERS) - {mavlink.MAVLINK_MSG_ID_TIMESYNC}
SENDABLE = KNOWN

# REQUEST_DATA_STREAM: messages of each stream, in the order in which ArduCopter sends them
_EXTRA1 = (mavlink.MAVLINK_MSG_ID_ATTITUDE, mavlink.MAVLINK_MSG_ID_SIMSTATE,
           mavlink.MAVLINK_MSG_ID_AHRS2)  # fmt: skip
_EXTENDED = (
    mavlink.MAVLINK_MSG_ID_SYS_STATUS, mavlink.MAVLINK_MSG_ID_POWER_STATUS,
    mavlink.MAVLINK_MSG_ID_MEMINFO, mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT,
    mavlink.MAVLINK_MSG_ID_MISSION_CURRENT, mavlink.MAVLINK_MSG_ID_GPS_RAW_INT,
)  # fmt: skip
_POSITION = (mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT, mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED)
_RAW = (
    mavlink.MAVLINK_MSG_ID_RAW_IMU, mavlink.MAVLINK_MSG_ID_SCALED_IMU2,
    mavlink.MAVLINK_MSG_ID_SCALED_IMU3, mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE,
    mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE2,
)  # fmt: skip
_RC = (mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW, mavlink.MAVLINK_MSG_ID_RC_CHANNELS)
_EXTRA2 = (mavlink.MAVLINK_MSG_ID_VFR_HUD,)
_EXTRA3 = (
    mavlink.MAVLINK_MSG_ID_AHRS, mavlink.MAVLINK_MSG_ID_SYSTEM_TIME, mavlink.MAVLINK_MSG_ID_WIND,
    mavlink.MAVLINK_MSG_ID_TERRAIN_REPORT, mavlink.MAVLINK_MSG_ID_BATTERY_STATUS,
    mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT, mavlink.MAVLINK_MSG_ID_VIBRATION,
    mavlink.MAVLINK_MSG_ID_ESC_TELEMETRY_1_TO_4,
)  # fmt: skip
TERRAIN_REQUEST_S = 2.0
STREAMS: dict[int, tuple[int, ...]] = {
    1: _RAW,
    2: _EXTENDED,
    3: _RC,
    6: _POSITION,
    10: _EXTRA1,
    11: _EXTRA2,
    12: _EXTRA3,
}
STREAMS[0] = (*_EXTRA1, *_POSITION, *_EXTENDED, *_EXTRA2, *_RC, *_RAW, *_EXTRA3)


def request_stream(vehicle: Vehicle, m: Message, port: int) -> None:
    """REQUEST_DATA_STREAM: start or stop the messages of a stream on the asking port."""
    rate_hz = m.req_message_rate if m.start_stop == 1 else 0
    period_s = 1.0 / rate_hz if rate_hz > 0 else 0.0
    for message_id in STREAMS.get(m.req_stream_id, ()):
        vehicle.ports[port].set_interval(message_id, period_s, vehicle.time_s)
    if m.req_stream_id in (0, 12):
        terrain_s = TERRAIN_REQUEST_S if period_s else 0.0
        request = mavlink.MAVLINK_MSG_ID_TERRAIN_REQUEST
        vehicle.ports[port].set_interval(request, terrain_s, vehicle.time_s)
