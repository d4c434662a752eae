"""What the vehicle tells about itself: one method per message, named after it.

Sensors and servos show plausible, still values in the recorded form.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from jfto_sim.arming import Arming
from jfto_sim.battery import Battery, BatteryState
from jfto_sim.config import VehicleConfig
from jfto_sim.dialect import Message, mavlink
from jfto_sim.estimator import Estimator
from jfto_sim.failsafe import Failsafes
from jfto_sim.flight import Flight
from jfto_sim.flight_loop import FlightLoop
from jfto_sim.modes.auto import Auto
from jfto_sim.modes.mode import NEEDS_POSITION, Mode, Modes

_ARMED = 128
# bits of HEARTBEAT.base_mode without the armed bit
_PLAIN, _GUIDED = 81, 89
_STANDBY, _ACTIVE, _CRITICAL, _BOOT_ACTIVE_UNTIL_S = 3, 4, 5, 2.2
# sensor bits of SYS_STATUS
_PRESENT = 0x5371FC0F
_GPS, _PREARM, _BATTERY, _FENCE, _REACHED_EKF = 0x20, 0x10000000, 0x2000000, 0x100000, 0x200000
_COMPASS = 0x4
_CAPABILITIES = 64495
_FLIGHT_SW_VERSION = 0x040505FF
_GIT_HASH = list(b"142aece2")
_SEA_LEVEL_HPA, _SCALE_M = 1013.25, 8434.0
_MAG = (217, 12, 429)
_BOARD_TEMPERATURE = 2847
_STICKS = (1500, 1500, 1000, 1500, 1800, 1000, 1000, 1800)  # at rest, throttle down


@dataclass(frozen=True)
class Telemetry:
    """Reads the parts of a vehicle and changes none."""

    config: VehicleConfig
    flight: Flight
    loop: FlightLoop
    estimator: Estimator
    battery: Battery
    modes: Modes
    auto: Auto
    arming: Arming
    failsafes: Failsafes

    @property
    def _time_ms(self) -> int:
        return self.flight.clock.time_ms

    @property
    def _time_us(self) -> int:
        return self.flight.clock.time_us

    @property
    def _attitude_rad(self) -> tuple[float, float, float]:
        """Roll, pitch, and yaw within ±π."""
        roll, pitch = self.flight.body.attitude_deg
        yaw = (self.flight.body.yaw_deg + 180.0) % 360.0 - 180.0
        return math.radians(roll), math.radians(pitch), math.radians(yaw)

    # --- how it is ---

    def heartbeat(self) -> Message:
        """Mode, armed, status."""
        mode = self.modes.current.number
        armed = self.flight.motors.armed
        flying = armed and not self.flight.land.complete
        booting = self.flight.clock.time_s < _BOOT_ACTIVE_UNTIL_S
        status = _ACTIVE if flying or booting else _STANDBY
        return mavlink.MAVLink_heartbeat_message(
            mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA,
            (_GUIDED if mode in NEEDS_POSITION else _PLAIN) | (_ARMED if armed else 0), int(mode),
            _CRITICAL if self.failsafes.critical else status, 3,
        )  # fmt: skip

    def sys_status(self) -> Message:
        """With the sensor bits that the recordings show."""
        now, params, battery = self.flight.clock.time_s, self.flight.params, self.battery
        origin = _REACHED_EKF if self.estimator.has_origin else 0
        present = _PRESENT | (_GPS if self.estimator.has_fix or now > 10 else 0)
        enabled = present & ~0x300000
        if now > 17.0 and self.modes.current.number in (Mode.STABILIZE, Mode.AUTO, Mode.LAND):
            enabled &= ~0x1000000
        if params["FENCE_ENABLE"]:
            enabled |= _FENCE
        enabled |= origin
        health = (present & ~0x18200000) | origin
        health |= _PREARM if self.arming.passing else 0
        if self.failsafes.fence.breached:
            health &= ~_FENCE
        if battery.state > BatteryState.HEALTHY:
            health &= ~_BATTERY
        if any(params[f"SIM_MAG{n}_FAIL"] for n in (1, 2, 3)):
            health &= ~_COMPASS
        return mavlink.MAVLink_sys_status_message(
            present, enabled, health, 0, round(battery.voltage_v * 1000),
            round(battery.current_a * 100), battery.remaining_percent, 0, 0, 0, 0, 0, 0,
        )  # fmt: skip

    def battery_status(self) -> Message:
        """Voltage as one cell, charge used."""
        b = self.battery
        cells = [round(b.voltage_v * 1000)] + [65535] * 9
        charge = {BatteryState.HEALTHY: 1, BatteryState.LOW: 2, BatteryState.CRITICAL: 3}[b.state]
        return mavlink.MAVLink_battery_status_message(
            0, 0, 0, 32767, cells, round(b.current_a * 100), round(b.consumed_mah),
            round(b.consumed_wh * 36), b.remaining_percent, 0, charge,
        )  # fmt: skip

    def autopilot_version(self) -> Message:
        """ArduCopter 4.5.5, with this vehicle's uid."""
        return mavlink.MAVLink_autopilot_version_message(
            _CAPABILITIES, _FLIGHT_SW_VERSION, 0, 0, 0, _GIT_HASH, [0] * 8, [0] * 8, 0, 0, 0,
            self.config.identity,
        )  # fmt: skip

    def extended_sys_state(self) -> Message:
        """1 on the ground, 2 in the air, 3 taking off, 4 landing."""
        mode = self.modes.current
        if self.flight.land.complete:
            landed = 1
        elif mode.landing:
            landed = 4
        else:
            landed = 3 if mode.taking_off else 2
        return mavlink.MAVLink_extended_sys_state_message(3, landed)

    def ekf_status_report(self) -> Message:
        """Flags with small variances."""
        flags = self.estimator.flags(flying=not self.flight.body.landed)
        return mavlink.MAVLink_ekf_status_report_message(
            flags, 0.008, 0.005, 0.001, 0.008, 0.0, 0.0
        )

    def fence_status(self) -> Message:
        """The last breach and how many there were."""
        f = self.failsafes
        breach_type = {1: 2, 2: 3, 4: 3, 8: 1}.get(f.fence.breached, 0)
        return mavlink.MAVLink_fence_status_message(
            1 if f.fence.breached else 0, f.fence_count, breach_type, int(f.fence_time_s * 1000), 1
        )

    def mission_current(self) -> Message:
        """What AUTO flies, or would."""
        return self.auto.current_message()

    def system_time(self) -> Message:
        """UTC and time since power-up."""
        return mavlink.MAVLink_system_time_message(self.flight.clock.utc_us, self._time_ms)

    # --- where it is ---

    def gps_raw_int(self) -> Message:
        """RTK fixed as in simulation, fix type 1 while the GPS is off."""
        if self.flight.clock.time_s < 9.9:
            return mavlink.MAVLink_gps_raw_int_message(
                0, 0, 0, 0, 0, 65535, 65535, 0, 0, 0, 0, 0, 0, 0, 0, 0
            )
        fix, satellites = (6, 10) if self.estimator.gps_present else (1, 3)
        lat, lon, alt_m = self.flight.position.reported()
        east, north, _ = self.flight.body.velocity_mps
        speed, alt = round(100 * math.hypot(east, north)), round(alt_m * 1000)
        course = round(math.degrees(math.atan2(east, north)) % 360 * 100) % 36000 if speed else 0
        stamp = int(self.flight.clock.time_s * 5) * 200_000 + 3000
        return mavlink.MAVLink_gps_raw_int_message(
            stamp, fix, lat, lon, alt, 121, 200, speed, course, satellites, alt, 300, 300, 40, 0, 0
        )

    def attitude(self) -> Message:
        """Angles; of the rates only yaw's."""
        rate = math.radians(self.flight.body.yaw_rate_dps)
        return mavlink.MAVLink_attitude_message(self._time_ms, *self._attitude_rad, 0.0, 0.0, rate)

    def local_position_ned(self) -> Message:
        """Relative to the EKF origin."""
        x, y, z = self.flight.body.position_m
        vx, vy, vz = self.flight.body.velocity_mps
        return mavlink.MAVLink_local_position_ned_message(self._time_ms, y, x, -z, vy, vx, -vz)

    def global_position_int(self) -> Message:
        """As the vehicle believes."""
        lat, lon, alt_m = self.flight.position.reported()
        vx, vy, vz = self.flight.body.velocity_mps
        return mavlink.MAVLink_global_position_int_message(
            self._time_ms, lat, lon, round(alt_m * 1000),
            round(self.flight.position.from_home_m[2] * 1000), round(vy * 100), round(vx * 100),
            round(-vz * 100), round(self.flight.body.yaw_deg * 100) % 36000,
        )  # fmt: skip

    def home_position(self) -> Message:
        """Home."""
        return self.flight.position.home_message()

    def gps_global_origin(self) -> Message:
        """The power-up point."""
        return self.flight.position.origin_message()

    def nav_controller_output(self) -> Message:
        """Tilt and what is being flown to; distance in whole metres."""
        body = self.flight.body
        distance, bearing = self.modes.current.goal
        return mavlink.MAVLink_nav_controller_output_message(
            *body.attitude_deg, round(bearing), round(bearing), min(65535, round(distance)),
            float(body.target[0, 2] - body.position_m[2]), 0.0, 0.0,
        )  # fmt: skip

    def vfr_hud(self) -> Message:
        """Airspeed, ground speed, heading, throttle, height, climb."""
        body = self.flight.body
        vx, vy, vz = body.velocity_mps
        wind = self.loop.wind_mps
        air, ground = math.hypot(vx - wind[0], vy - wind[1]), math.hypot(vx, vy)
        throttle = 39 if self.flight.motors.armed and not body.landed else 0
        alt_m = self.flight.position.reported()[2]
        return mavlink.MAVLink_vfr_hud_message(
            air, ground, round(body.yaw_deg) % 360, throttle, alt_m, vz
        )

    def ahrs(self) -> Message:
        """Still."""
        return mavlink.MAVLink_ahrs_message(0.0, 0.0, 0.0, 0.0, 0.0, 0.0025, 0.0024)

    def ahrs2(self) -> Message:
        """The second estimate, which agrees."""
        lat, lon, alt_m = self.flight.position.reported()
        return mavlink.MAVLink_ahrs2_message(*self._attitude_rad, alt_m, lat, lon)

    def simstate(self) -> Message:
        """The simulator's own truth, without noise."""
        return mavlink.MAVLink_simstate_message(
            *self._attitude_rad, 0.0, 0.0, -9.80665, 0.0, 0.0, 0.0, *self.flight.position.true()
        )

    def wind(self) -> Message:
        """Where it comes from, where drag was made known to the estimator; else none, as real ones.

        Without EK3_DRAG_BCOEF_X and _Y a copter knows nothing of the wind, and says 0 m/s in any.
        """
        drag = min(self.flight.params[f"EK3_DRAG_BCOEF_{axis}"] for axis in "XY")
        told = drag > 0 and not self.flight.body.landed
        east, north = self.loop.wind_mps if told else (0.0, 0.0)
        speed = math.hypot(east, north)
        direction = math.degrees(math.atan2(-east, -north)) if speed > 0 else -180.0
        return mavlink.MAVLink_wind_message(direction, speed, 0.0)

    def terrain_report(self) -> Message:
        """Nothing is loaded."""
        lat, lon, alt_m = self.flight.position.reported()
        return mavlink.MAVLink_terrain_report_message(lat, lon, 0, 0.0, alt_m, 504, 0)

    def terrain_request(self) -> Message:
        """For the block around home."""
        lat, lon = self.flight.position.origin
        return mavlink.MAVLink_terrain_request_message(lat - 96676, lon - 273711, 100, 2**56 - 1)

    # --- sensors and servos ---

    def raw_imu(self) -> Message:
        """At rest."""
        return mavlink.MAVLink_raw_imu_message(
            self._time_us, 0, 0, -1000, 0, 0, 0, *_MAG, 0, _BOARD_TEMPERATURE
        )

    def scaled_imu2(self) -> Message:
        """At rest."""
        return mavlink.MAVLink_scaled_imu2_message(
            self._time_ms, 0, 0, -1000, 0, 0, 0, *_MAG, _BOARD_TEMPERATURE
        )

    def scaled_imu3(self) -> Message:
        """Compass only."""
        return mavlink.MAVLink_scaled_imu3_message(self._time_ms, 0, 0, 0, 0, 0, 0, *_MAG, 0)

    def _pressure(self) -> tuple[int, float, float, int]:
        """Time, hPa at the present height, difference, temperature in 0.01 °C."""
        alt_m = self.flight.position.reported()[2]
        return self._time_ms, _SEA_LEVEL_HPA * math.exp(-alt_m / _SCALE_M), 0.0, 3086

    def scaled_pressure(self) -> Message:
        """The first barometer."""
        return mavlink.MAVLink_scaled_pressure_message(*self._pressure())

    def scaled_pressure2(self) -> Message:
        """The second barometer."""
        return mavlink.MAVLink_scaled_pressure2_message(*self._pressure())

    def power_status(self) -> Message:
        """5 V."""
        return mavlink.MAVLink_power_status_message(5000, 0, 0)

    def meminfo(self) -> Message:
        """Enough."""
        return mavlink.MAVLink_meminfo_message(0, 65535, 131072)

    def servo_output_raw(self) -> Message:
        """Four motors."""
        flying = self.flight.motors.armed and not self.flight.body.landed
        speed = 1500 if flying else 1000
        return mavlink.MAVLink_servo_output_raw_message(
            self._time_us & 0xFFFFFFFF, 0, *([speed] * 4), *([0] * 4)
        )

    def rc_channels(self) -> Message:
        """Sticks at rest."""
        return mavlink.MAVLink_rc_channels_message(self._time_ms, 16, *_STICKS, *([0] * 10), 255)

    def vibration(self) -> Message:
        """Almost none."""
        return mavlink.MAVLink_vibration_message(self._time_us, 0.003, 0.003, 0.003, 0, 0, 0)

    def esc_telemetry_1_to_4(self) -> Message:
        """Four equal motors; the count goes on."""
        count = int(self.flight.clock.time_s * 400) & 0xFFFF
        return mavlink.MAVLink_esc_telemetry_1_to_4_message(
            [32] * 4, [1679] * 4, [80] * 4, [1] * 4, [0] * 4, [count] * 4
        )


# Names of the methods by the id of their message: what may be asked for.
MESSAGES = {
    getattr(mavlink, f"MAVLINK_MSG_ID_{name.upper()}"): name
    for name in vars(Telemetry)
    if not name.startswith("_")
}
