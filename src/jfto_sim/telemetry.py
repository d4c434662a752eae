"""Messages that tell where the vehicle is and how it is."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from jfto_sim.battery import BatteryState
from jfto_sim.dialect import Message, mavlink
from jfto_sim.mission.runner import RunState
from jfto_sim.modes.numbers import BASE_MODE, Mode

if TYPE_CHECKING:
    from jfto_sim.vehicle import Vehicle

_ARMED = 128
_STANDBY, _ACTIVE, _CRITICAL, _BOOT_ACTIVE_UNTIL_S = 3, 4, 5, 2.2
_NAN = float("nan")
# sensor bits of SYS_STATUS
_PRESENT = 0x5371FC0F
_GPS, _PREARM, _BATTERY, _FENCE, _REACHED_EKF = 0x20, 0x10000000, 0x2000000, 0x100000, 0x200000
_COMPASS, _POSITION_CONTROL, _MOTORS, _LOGGING = 0x4, 0x6000, 0x8000, 0x1000000
_CAPABILITIES = 64495
_FLIGHT_SW_VERSION = 0x040505FF
_GIT_HASH = list(b"142aece2")


def heartbeat(v: Vehicle) -> Message:
    """HEARTBEAT."""
    armed = _ARMED if v.arming.armed else 0
    flying = v.arming.armed and not v.land_complete
    status = _ACTIVE if flying or v.time_s < _BOOT_ACTIVE_UNTIL_S else _STANDBY
    if v.failsafes.critical:
        status = _CRITICAL
    return mavlink.MAVLink_heartbeat_message(
        mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA,
        BASE_MODE[v.mode.number] | armed, int(v.mode.number), status, 3,
    )  # fmt: skip


def sys_status(v: Vehicle) -> Message:
    """SYS_STATUS with the sensor bits that the recordings show."""
    now = v.time_s
    present = _PRESENT | (_GPS if v.estimator.has_fix(now) or now > 10 else 0)
    enabled = present & ~0x300000
    if now > 17.0 and v.mode.number in (Mode.STABILIZE, Mode.AUTO, Mode.LAND):
        enabled &= ~0x1000000
    if v.params["FENCE_ENABLE"]:
        enabled |= _FENCE
    if v.estimator.has_origin(now):
        enabled |= _REACHED_EKF
    health = (present & ~0x18200000) | (_REACHED_EKF if v.estimator.has_origin(now) else 0)
    health |= _PREARM if v.arming.passing else 0
    if v.failsafes.fence_breach:
        health &= ~_FENCE
    if v.battery.state > BatteryState.HEALTHY:
        health &= ~_BATTERY
    if any(v.params[f"SIM_MAG{n}_FAIL"] for n in (1, 2, 3)):
        health &= ~_COMPASS
    return mavlink.MAVLink_sys_status_message(
        present, enabled, health, 0, round(v.battery.voltage_v * 1000),
        round(v.battery.current_a * 100), v.battery.remaining_percent, 0, 0, 0, 0, 0, 0,
    )  # fmt: skip


def system_time(v: Vehicle) -> Message:
    """SYSTEM_TIME."""
    return mavlink.MAVLink_system_time_message(v.utc_us, v.time_ms)


def gps_raw_int(v: Vehicle) -> Message:
    """GPS_RAW_INT: RTK fixed as in simulation, fix type 1 while the GPS is off."""
    if v.time_s < 9.9:
        return mavlink.MAVLink_gps_raw_int_message(
            0, 0, 0, 0, 0, 65535, 65535, 0, 0, 0, 0, 0, 0, 0, 0, 0
        )
    fix, seen = (6, 10) if v.estimator.gps_present else (1, 3)
    lat, lon, alt_m = v.reported_position()
    east, north, _ = v.body.velocity_mps
    speed, alt = round(100 * math.hypot(east, north)), round(alt_m * 1000)
    course = round(math.degrees(math.atan2(east, north)) % 360 * 100) % 36000 if speed else 0
    stamp = int(v.time_s * 5) * 200_000 + 3000
    return mavlink.MAVLink_gps_raw_int_message(
        stamp, fix, lat, lon, alt, 121, 200, speed, course, seen, alt, 300, 300, 40, 0, 0
    )


def attitude(v: Vehicle) -> Message:
    """ATTITUDE."""
    roll, pitch = v.body.attitude_deg
    yaw = math.radians((v.body.yaw_deg + 180.0) % 360.0 - 180.0)
    rate = math.radians(v.body.yaw_rate_dps)
    return mavlink.MAVLink_attitude_message(
        v.time_ms, math.radians(roll), math.radians(pitch), yaw, 0.0, 0.0, rate
    )


def local_position_ned(v: Vehicle) -> Message:
    """LOCAL_POSITION_NED, relative to the EKF origin."""
    x, y, z = v.body.position_m
    vx, vy, vz = v.body.velocity_mps
    return mavlink.MAVLink_local_position_ned_message(v.time_ms, y, x, -z, vy, vx, -vz)


def global_position_int(v: Vehicle) -> Message:
    """GLOBAL_POSITION_INT."""
    lat, lon, alt_m = v.reported_position()
    vx, vy, vz = v.body.velocity_mps
    return mavlink.MAVLink_global_position_int_message(
        v.time_ms, lat, lon, round(alt_m * 1000), round(v.height_above_home_m * 1000),
        round(vy * 100), round(vx * 100), round(-vz * 100), round(v.body.yaw_deg * 100) % 36000,
    )  # fmt: skip


def mission_state(v: Vehicle) -> int:
    """1 no mission, 2 not started, 3 active, 4 paused, 5 complete."""
    runner = v.auto.runner
    if v.store.count(0) <= 1:
        return 1
    if v.mode.number != Mode.AUTO:
        return 2
    if runner.state is RunState.COMPLETE:
        return 5
    return 4 if v.auto.nav.paused else 3


def mission_current(v: Vehicle) -> Message:
    """MISSION_CURRENT."""
    runner = v.auto.runner
    return mavlink.MAVLink_mission_current_message(
        runner.nav or 0, max(0, v.store.count(0) - 1), mission_state(v),
        1 if v.mode.number == Mode.AUTO else 0,
    )  # fmt: skip


def nav_controller_output(v: Vehicle) -> Message:
    """NAV_CONTROLLER_OUTPUT; distance in whole metres."""
    roll, pitch = v.body.attitude_deg
    distance, bearing = v.goal()
    return mavlink.MAVLink_nav_controller_output_message(
        roll, pitch, round(bearing), round(bearing), min(65535, round(distance)),
        float(v.body.target[0, 2] - v.body.position_m[2]), 0.0, 0.0,
    )  # fmt: skip


def vfr_hud(v: Vehicle) -> Message:
    """VFR_HUD."""
    vx, vy, vz = v.body.velocity_mps
    wind = v.wind_mps
    air, ground = math.hypot(vx - wind[0], vy - wind[1]), math.hypot(vx, vy)
    throttle = 39 if v.arming.armed and not v.body.landed else 0
    return mavlink.MAVLink_vfr_hud_message(
        air, ground, round(v.body.yaw_deg) % 360, throttle, v.reported_position()[2], vz
    )


def battery_status(v: Vehicle) -> Message:
    """BATTERY_STATUS."""
    b = v.battery
    cells = [round(b.voltage_v * 1000)] + [65535] * 9
    charge = {BatteryState.HEALTHY: 1, BatteryState.LOW: 2, BatteryState.CRITICAL: 3}[b.state]
    return mavlink.MAVLink_battery_status_message(
        0, 0, 0, 32767, cells, round(b.current_a * 100), round(b.consumed_mah),
        round(b.consumed_wh * 36), b.remaining_percent, 0, charge,
    )  # fmt: skip


def autopilot_version(v: Vehicle) -> Message:
    """AUTOPILOT_VERSION of ArduCopter 4.5.5, with this vehicle's uid."""
    return mavlink.MAVLink_autopilot_version_message(
        _CAPABILITIES, _FLIGHT_SW_VERSION, 0, 0, 0, _GIT_HASH, [0] * 8, [0] * 8, 0, 0, 0,
        v.config.identity,
    )  # fmt: skip


def extended_sys_state(v: Vehicle) -> Message:
    """EXTENDED_SYS_STATE: 1 on the ground, 2 in the air, 3 taking off, 4 landing."""
    if v.land_complete:
        landed = 1
    elif v.mode.landing:
        landed = 4
    else:
        landed = 3 if v.mode.taking_off else 2
    return mavlink.MAVLink_extended_sys_state_message(3, landed)


def home_position(v: Vehicle) -> Message:
    """HOME_POSITION; x, y, z are metres north, east, down of the EKF origin."""
    lat, lon, alt_m = v.home_item()
    east, north, up = v.home_m
    return mavlink.MAVLink_home_position_message(
        lat, lon, round(alt_m * 1000), north, east, -up, [_NAN] * 4, 0.0, 0.0, 0.0, v.time_us
    )


def gps_global_origin(v: Vehicle) -> Message:
    """GPS_GLOBAL_ORIGIN."""
    lat, lon = v.origin
    alt = round(v.config.home_alt_m * 1000)
    return mavlink.MAVLink_gps_global_origin_message(lat, lon, alt, v.time_us)


def ekf_status_report(v: Vehicle) -> Message:
    """EKF_STATUS_REPORT."""
    flags = v.estimator.flags(v.time_s, flying=not v.body.landed)
    return mavlink.MAVLink_ekf_status_report_message(flags, 0.008, 0.005, 0.001, 0.008, 0.0, 0.0)


def fence_status(v: Vehicle) -> Message:
    """FENCE_STATUS."""
    f = v.failsafes
    breach_type = {1: 2, 2: 3, 4: 3, 8: 1}.get(f.fence_breach, 0)
    return mavlink.MAVLink_fence_status_message(
        1 if f.fence_breach else 0, f.fence_count, breach_type, int(f.fence_time_s * 1000), 1
    )


def timesync(v: Vehicle) -> Message:
    """TIMESYNC request, in nanoseconds of the vehicle's clock."""
    return mavlink.MAVLink_timesync_message(0, v.time_us * 1000 + v.config.sysid)
