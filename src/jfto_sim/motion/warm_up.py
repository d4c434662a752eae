"""Compiling before anything flies."""

from __future__ import annotations

from dataclasses import replace

from jfto_sim.motion.body import Body
from jfto_sim.motion.waypoint_nav import WaypointNav
from jfto_world.motion.arducopter.wpnav import Airframe, WpNav

_STEP_S, _STEPS = 0.01, 10


def warm_up() -> None:
    """Fly a short leg with a corner and a change of speed on no one's account.

    The first use of the motion kernels on a machine compiles them, which takes seconds and stops
    every thread of the process: a vehicle must not fall silent for that in the air.
    """
    wpnav = WpNav()
    body = Body(Airframe(), 0.0)
    nav = WaypointNav(body, wpnav)
    body.lift_off()
    nav.begin((0.0, 0.0, 10.0))
    nav.set_destination((0.0, 40.0, 10.0))
    nav.set_next((40.0, 40.0, 20.0))
    for step in range(_STEPS):
        if step == _STEPS // 2:
            nav.set_limits(replace(wpnav, speed_mps=wpnav.speed_mps / 2))
        nav.step(_STEP_S)
        body.fly((0.0, 0.0), _STEP_S)
