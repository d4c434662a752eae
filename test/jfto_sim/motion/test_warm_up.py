"""Compiling before anything flies."""

from __future__ import annotations

from jfto_sim.motion.waypoint_nav import warm_up
from jfto_world.motion.arducopter import follower, leg_profile


def test_every_kernel_of_a_flight_is_compiled_beforehand() -> None:
    """Afterwards the kernels that a step of flight calls have a compiled form."""
    warm_up()
    kernels = (
        leg_profile.fill_leg,
        leg_profile.half_overlap_s,
        leg_profile.solve_speed_up,
        leg_profile.speed_up,
        follower.clock_step,
        follower.follow_step,
    )
    assert all(kernel.signatures for kernel in kernels)
