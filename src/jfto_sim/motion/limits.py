"""The waypoint planner's limits: what the parameters say, and what a command asked for instead."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_sim.motion.body import Body
from jfto_sim.parameters import Parameters
from jfto_world.motion.arducopter.wpnav import WpNav

_LEAST_SPEED_CMS = 20.0


@dataclass
class Limits:
    """Speeds asked for by a command (`speed_mps`, `climb_mps`, `sink_mps`) replace parameters'."""

    params: Parameters
    body: Body
    speed_mps: float | None = None
    climb_mps: float | None = None
    sink_mps: float | None = None
    _wpnav: WpNav | None = None

    @property
    def wpnav(self) -> WpNav:
        """The planner's parameters as they stand."""
        if self._wpnav is None:
            self._wpnav = self.at(0.0)
        return self._wpnav

    def at(self, speed_cms: float) -> WpNav:
        """The same with another horizontal speed; 0 means WPNAV_SPEED."""
        p = self.params
        if speed_cms <= 0 and self.speed_mps is not None:
            speed_cms = 100.0 * self.speed_mps
        speed = max(speed_cms if speed_cms > 0 else p["WPNAV_SPEED"], _LEAST_SPEED_CMS)
        up = self.climb_mps or max(p["WPNAV_SPEED_UP"], 10.0) / 100.0
        down = self.sink_mps or max(p["WPNAV_SPEED_DN"], 10.0) / 100.0
        return WpNav(
            speed_mps=speed / 100.0,
            speed_up_mps=up,
            speed_dn_mps=down,
            accel_mps2=max(p["WPNAV_ACCEL"], 50.0) / 100.0,
            accel_z_mps2=max(p["WPNAV_ACCEL_Z"], 50.0) / 100.0,
            corner_accel_mps2=max(p["WPNAV_ACCEL_C"], 0.0) / 100.0,
            jerk_mps3=max(p["WPNAV_JERK"], 0.1),
            radius_m=max(p["WPNAV_RADIUS"], 5.0) / 100.0,
            input_tc_s=max(p["ATC_INPUT_TC"], 0.01),
            angle_max_deg=min(max(p["ANGLE_MAX"], 1000.0), 8000.0) / 100.0,
        )

    def reread(self) -> None:
        """A parameter has changed."""
        self._wpnav = None
        self.body.configure(self.wpnav)

    @property
    def jerk_xy_mps3(self) -> float:
        """PSC_JERK_XY."""
        return max(self.params["PSC_JERK_XY"], 0.5)

    @property
    def jerk_z_mps3(self) -> float:
        """PSC_JERK_Z."""
        return max(self.params["PSC_JERK_Z"], 0.5)
