"""What every flight mode offers, and the pieces of flying that several share."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jfto_sim.modes.numbers import Mode
from jfto_sim.motion.shaping import LevelTarget, VerticalTarget, sqrt_controller

if TYPE_CHECKING:
    from jfto_sim.vehicle import Vehicle

_SPOOL_UP_S, _SPOOL_AFTER_ARM_S = 0.9, 3.15
_TAKEOFF_SHARE, _TAKEOFF_SLOW = 0.9, 0.1
_LAND_GAIN = 1.0


class FlightMode:
    """One mode; `enter` may refuse, `step` moves the body's target."""

    number: Mode

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle
        self.body = vehicle.body

    def enter(self) -> bool:
        """Begin; false refuses the change."""
        return True

    def leave(self) -> None:
        """End."""

    def step(self, dt_s: float) -> None:
        """Move the target by one step."""

    @property
    def landing(self) -> bool:
        """Whether the mode brings the vehicle down."""
        return False

    @property
    def taking_off(self) -> bool:
        """Whether the mode lifts the vehicle off the ground."""
        return False


class Mover:
    """Shared target: a horizontal part and a vertical part, written to the body."""

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle
        self.body = vehicle.body
        self.level = LevelTarget()
        self.vertical = VerticalTarget()

    def reset(self) -> None:
        """Start from the body's own motion."""
        x, y, z = self.body.position_m
        vx, vy, vz = self.body.velocity_mps
        self.level.reset((x, y), (vx, vy))
        self.vertical.reset(z, vz)
        self.write()

    def write(self) -> None:
        """Hand the target to the body."""
        target = self.body.target
        for k in (0, 1):
            target[0, k] = self.level.position_m[k]
            target[1, k] = self.level.velocity_mps[k]
            target[2, k] = self.level.accel_mps2[k]
        target[0, 2] = self.vertical.height_m
        target[1, 2] = self.vertical.climb_mps
        target[2, 2] = self.vertical.accel_mps2

    def brake(self, accel_mps2: float, jerk_mps3: float, dt_s: float) -> None:
        """Come to rest horizontally."""
        self.level.towards_velocity((0.0, 0.0), (0.0, 0.0), accel_mps2, jerk_mps3, dt_s)

    def climb(self, rate_mps: float, dt_s: float) -> None:
        """Climb or sink at a rate."""
        p = self.vehicle.wpnav
        self.vertical.towards_climb(rate_mps, p.accel_z_mps2, self.vehicle.jerk_z_mps3, dt_s)


class Takeoff:
    """Straight up from the ground, or from where the vehicle is, to a height."""

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle
        self.mover = Mover(vehicle)
        self.height_m = 0.0
        self.start_m = 0.0
        self.begins_s = 0.0
        self.done = False

    def start(self, height_m: float) -> None:
        """`height_m` above the power-up point; never below the present height."""
        body = self.vehicle.body
        now = self.vehicle.time_s
        self.mover.reset()
        self.start_m = body.position_m[2]
        self.height_m = max(height_m, self.start_m)
        armed_for = now - self.vehicle.arming.armed_at_s
        self.begins_s = now
        if body.landed:
            self.begins_s += max(_SPOOL_UP_S, _SPOOL_AFTER_ARM_S - armed_for)
            self.begins_s += self.vehicle.config.hesitation_s
        self.done = False

    def step(self, dt_s: float) -> None:
        """Climb once the motors are up to speed."""
        if self.vehicle.time_s < self.begins_s:
            return
        if self.vehicle.body.landed:
            self.vehicle.body.lift_off()
            self.mover.reset()
        p, v = self.vehicle.wpnav, self.mover.vertical
        v.towards_height(
            self.height_m,
            (p.speed_up_mps, p.speed_dn_mps),
            p.accel_z_mps2,
            self.vehicle.jerk_z_mps3,
            dt_s,
        )
        self.mover.brake(p.accel_mps2, self.vehicle.jerk_xy_mps3, dt_s)
        self.mover.write()
        climbed = v.height_m - self.start_m >= _TAKEOFF_SHARE * (self.height_m - self.start_m)
        if climbed and v.climb_mps < _TAKEOFF_SLOW * p.speed_up_mps:
            self.done = True


class Descent:
    """Vertical landing at the speeds of LAND_*; touchdown is the vehicle's business."""

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle
        self.mover = Mover(vehicle)
        self.place: tuple[float, float] | None = None

    def start(self, place_m: tuple[float, float] | None = None) -> None:
        """Land where the vehicle can stop, or at a place."""
        self.mover.reset()
        self.place = place_m
        self.vehicle.heading.hold(self.vehicle.heading.demand_deg)

    def step(self, dt_s: float, *, hold: bool = False) -> None:
        """Sink: fast above LAND_ALT_LOW, then at LAND_SPEED; or hold the height for now."""
        v = self.vehicle
        p = v.wpnav
        low_m = v.params["LAND_ALT_LOW"] / 100.0
        fast = v.params["LAND_SPEED_HIGH"] / 100.0 or p.speed_dn_mps
        slow = v.params["LAND_SPEED"] / 100.0
        above = low_m - v.height_above_home_m
        rate = sqrt_controller(above, _LAND_GAIN, p.accel_z_mps2, dt_s)
        self.mover.climb(0.0 if hold else max(-max(fast, slow), min(-slow, rate)), dt_s)
        if self.place is None:
            self.mover.brake(p.accel_mps2, v.jerk_xy_mps3, dt_s)
        else:
            limits = (p.speed_mps, p.accel_mps2, v.jerk_xy_mps3)
            still = ((0.0, 0.0), (0.0, 0.0))
            self.mover.level.towards_position(self.place, still, limits, dt_s)
        self.mover.write()
