"""GUIDED: takeoff, single goals, and streamed position, velocity and acceleration targets."""

from __future__ import annotations

import math
from enum import Enum

from jfto_sim.dialect import Message
from jfto_sim.flight import Flight
from jfto_sim.mission.fence import Fence
from jfto_sim.modes.mode import FlightMode, Mode, Mover, Takeoff
from jfto_sim.motion.heading import YawMode
from jfto_sim.motion.waypoint_nav import WaypointNav
from jfto_sim.ports import MessageHandler

Vector = tuple[float, float, float]
_STOPPED_MPS2 = 2.5
_POSITION, _VELOCITY, _ACCEL, _FORCE, _YAW, _YAW_RATE = 0x7, 0x38, 0x1C0, 0x200, 0x400, 0x800
_LOCAL, _LOCAL_OFFSET, _BODY, _BODY_OFFSET = 1, 7, 8, 9
_WPNAV_FOR_POSITIONS = 64
_ABSURD = 1e7  # metres, metres per second: beyond what a position can hold


class Goal(Enum):
    """What the station last asked for."""

    NONE = "hold"
    TAKEOFF = "takeoff"
    POSITION = "position"
    MOVING = "position and velocity"
    VELOCITY = "velocity"
    ACCELERATION = "acceleration"
    WAYPOINT = "waypoint"


class Guided(FlightMode):
    """Follows targets; after GUID_TIMEOUT without one, a moving target comes to rest.

    A place that `fence` forbids is not flown to: the target before it stays in force.
    """

    number = Mode.GUIDED

    def __init__(self, flight: Flight, fence: Fence) -> None:
        super().__init__(flight)
        self._fence = fence
        self.accel = [0.0, 0.0, 0.0]
        self._mover = Mover(flight)
        self._takeoff = Takeoff(flight)
        self._nav = WaypointNav(flight.body, flight.limits.wpnav)
        self._goal = Goal.NONE
        self._position = [0.0, 0.0, 0.0]
        self._velocity = [0.0, 0.0, 0.0]
        self._target_at_s = 0.0
        self.messages: dict[str, MessageHandler] = {
            "SET_POSITION_TARGET_LOCAL_NED": lambda m, _port: self._local_ned(m),
            "SET_POSITION_TARGET_GLOBAL_INT": lambda m, _port: self._global_int(m),
        }

    def enter(self) -> bool:
        """Hold where the vehicle can stop."""
        self._mover.reset()
        self._goal = Goal.NONE
        self.flight.heading.hold()
        return True

    @property
    def taking_off(self) -> bool:
        """Whether a takeoff is in progress."""
        return self._goal is Goal.TAKEOFF

    @property
    def goal(self) -> tuple[float, float]:
        """Horizontal distance in metres to a position asked for; no bearing."""
        if self._goal not in (Goal.POSITION, Goal.MOVING):
            return 0.0, 0.0
        x, y, _ = self.flight.body.position_m
        return math.hypot(self._position[0] - x, self._position[1] - y), 0.0

    def begin_takeoff(self, height_m: float) -> None:
        """NAV_TAKEOFF: climb to a height above the power-up point."""
        self._goal = Goal.TAKEOFF
        self._takeoff.start(height_m)

    def aim(self, position: Vector | None, velocity: Vector | None, accel: Vector | None) -> bool:
        """Take a new target; None for a part that the station left out. False: the fence forbids.

        A velocity alone is never refused.
        """
        if position is not None and not self._fence.allows(position):
            return False
        before = self._goal
        if position is not None:
            moving = velocity is not None or accel is not None
            self._goal = Goal.MOVING if moving else Goal.POSITION
        elif velocity is not None:
            self._goal = Goal.VELOCITY
        else:
            self._goal = Goal.ACCELERATION
        if before is not self._goal or before in (Goal.NONE, Goal.TAKEOFF):
            self._mover.reset()
        self._target_at_s = self.flight.clock.time_s
        if position is not None:
            self._position = list(position)
        self._velocity = list(velocity or (0.0, 0.0, 0.0))
        self.accel = list(accel or (0.0, 0.0, 0.0))
        if self.flight.heading.mode is YawMode.HOLD:
            self.flight.heading.follow_track()
        return True

    def _fly_to(self, position: Vector | None) -> None:
        """GUID_OPTIONS 64: one goal by the waypoint planner, which every new goal restarts."""
        if position is None or not self._fence.allows(position):
            return
        self._goal = Goal.WAYPOINT
        self._nav.start(self.flight.limits.wpnav)
        self._nav.set_destination(position)

    # --- SET_POSITION_TARGET messages: which fields count, in which frame ---

    def _listening(self, m: Message) -> bool:
        return self.active and self.flight.motors.armed and not m.type_mask & _FORCE

    def _local_ned(self, m: Message) -> None:
        """Metres north, east, down of the EKF origin or of the body."""
        frames = (_LOCAL, _LOCAL_OFFSET, _BODY, _BODY_OFFSET)
        if not self._listening(m) or m.coordinate_frame not in frames:
            return
        turn_deg = self.flight.body.yaw_deg if m.coordinate_frame in (_BODY, _BODY_OFFSET) else 0.0
        position = _enu((m.x, m.y, m.z), turn_deg)
        if m.coordinate_frame != _LOCAL:
            x, y, z = self.flight.body.position_m
            position = (position[0] + x, position[1] + y, position[2] + z)
        velocity, accel = _enu((m.vx, m.vy, m.vz), turn_deg), _enu((m.afx, m.afy, m.afz), turn_deg)
        self._take(m, position, velocity, accel)

    def _global_int(self, m: Message) -> None:
        """Acceleration is ignored when a position is given."""
        if not self._listening(m):
            return
        height = self.flight.position.height_of(m.alt, m.coordinate_frame)
        if height is None:
            return
        position = (*self.flight.position.local_m(m.lat_int, m.lon_int), height)
        velocity, accel = _enu((m.vx, m.vy, m.vz)), _enu((m.afx, m.afy, m.afz))
        if _given(m, _POSITION):
            accel = (0.0, 0.0, 0.0)
        self._take(m, position, velocity, accel)

    def _take(self, m: Message, position: Vector, velocity: Vector, accel: Vector) -> None:
        parts = (
            position if _given(m, _POSITION) else None,
            velocity if _given(m, _VELOCITY) else None,
            accel if _given(m, _ACCEL) else None,
        )
        given = [part for part in parts if part is not None]
        if not given or not all(abs(x) < _ABSURD for part in given for x in part):
            return
        options = int(self.flight.params["GUID_OPTIONS"])
        if options & _WPNAV_FOR_POSITIONS and parts[1] is None and parts[2] is None:
            self._fly_to(parts[0])
        else:
            self.aim(*parts)
        self._take_yaw(m)

    def _take_yaw(self, m: Message) -> None:
        heading = self.flight.heading
        yaw_given = _given(m, _YAW) and math.isfinite(m.yaw)
        rate_given = _given(m, _YAW_RATE) and math.isfinite(m.yaw_rate)
        if yaw_given:
            heading.stream(math.degrees(m.yaw), math.degrees(m.yaw_rate) if rate_given else 0.0)
        elif rate_given:
            heading.set_rate(math.degrees(m.yaw_rate))
        elif heading.mode is not YawMode.FIXED:
            heading.follow_track()

    # --- one step ---

    def step(self, dt_s: float) -> None:
        """Move the target."""
        if self._goal is Goal.TAKEOFF:
            self._takeoff.step(dt_s)
            if self._takeoff.done:
                self._mover.reset()
                self._position = [*self.flight.body.position_m[:2], self._takeoff.height_m]
                self._mover.vertical.reset(self._takeoff.mover.vertical.height_m)
                self._goal = Goal.POSITION
            return
        if self.flight.body.landed:
            return
        if self._goal is Goal.WAYPOINT:
            self._nav.step(dt_s)
            return
        silent_s = self.flight.clock.time_s - self._target_at_s
        moving = self._goal in (Goal.MOVING, Goal.VELOCITY, Goal.ACCELERATION)
        if moving and silent_s > self.flight.params["GUID_TIMEOUT"]:
            self._velocity, self.accel = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
        self._step_level(dt_s)
        self._step_vertical(dt_s)
        self._mover.write()

    def _step_level(self, dt_s: float) -> None:
        p, jerk = self.flight.limits.wpnav, self.flight.limits.jerk_xy_mps3
        level, velocity, accel = self._mover.level, self._velocity, self.accel
        if self._goal is Goal.NONE:
            self._mover.brake(_STOPPED_MPS2, jerk, dt_s)
            return
        placed = self._goal in (Goal.POSITION, Goal.MOVING)
        for k in (0, 1):
            if placed:
                self._position[k] += dt_s * (velocity[k] + 0.5 * dt_s * accel[k])
            velocity[k] += dt_s * accel[k]
        feed = ((velocity[0], velocity[1]), (accel[0], accel[1]))
        if placed:
            aim = (self._position[0], self._position[1])
            level.towards_position(aim, feed, (p.speed_mps, p.accel_mps2, jerk), dt_s)
        else:
            level.towards_velocity(*feed, p.accel_mps2, jerk, dt_s)

    def _step_vertical(self, dt_s: float) -> None:
        placed = self._goal in (Goal.POSITION, Goal.MOVING)
        if placed:
            self._position[2] += dt_s * (self._velocity[2] + 0.5 * dt_s * self.accel[2])
        self._velocity[2] += dt_s * self.accel[2]
        if placed:
            self._mover.climb_to(self._position[2], dt_s, self._velocity[2])
        else:
            self._mover.climb(0.0 if self._goal is Goal.NONE else self._velocity[2], dt_s)


def _given(m: Message, bits: int) -> bool:
    """A part counts only if none of its bits says ignore."""
    return not m.type_mask & bits


def _enu(ned: Vector, turn_deg: float = 0.0) -> Vector:
    """East, north, up of a vector whose north points `turn_deg` degrees clockwise."""
    north, east, down = ned
    if turn_deg:
        yaw = math.radians(turn_deg)
        forward, right = north, east
        north = forward * math.cos(yaw) - right * math.sin(yaw)
        east = forward * math.sin(yaw) + right * math.cos(yaw)
    return east, north, -down
