"""Compile all kernels before anything waits for them.

Each part of the program is used once on data of the smallest size. What numba makes of that stays
on disk, so that no later use is held up, least of all one against the clock.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from jfto_msgs_py.records.radio import Radio
from jfto_planner.routing import RoutingProblem
from jfto_world.motion import ConstantSpeed, MotionLimits
from jfto_world.radio import Channel, make_channel

_POINTS = np.array([[0.0, 0.0, 10.0], [0.0, 30.0, 12.0], [25.0, 30.0, 10.0], [25.0, 0.0, 14.0]])


def compile_kernels(say: Callable[[str], None]) -> int:
    """Compile or load every kernel, and return how many there are; `say` is told what comes."""
    from jfto_world.compiled import kernels

    parts = {
        "terrain": _terrain,
        "motion": _motion,
        "topology and power": _network,
        "routes": _routes,
        "curves": _curves,
        "learned routes": _learned_routes,
    }
    for name, use in parts.items():
        say(name)
        use()
    return len(kernels)


def _terrain() -> None:
    from jfto_world.terrain.cubic_surface import CubicSurface, cell_ceilings, first_hit

    surface = CubicSurface.through(np.zeros((3, 3)), 0.0, 0.0, 1.0, 1.0)
    surface.height_and_gradient(np.ones(1), np.ones(1))
    down = np.array([[0.0, 0.0, -1.0]])
    first_hit(surface, cell_ceilings(surface), np.ones((1, 3)), down, np.full(1, 9.0))


def _motion() -> None:
    from jfto_msgs_py.records.vehicle import TimedTrajectory
    from jfto_sim.motion.waypoint_nav import warm_up
    from jfto_world.motion.arducopter import ArduCopter, WpNav, fly_route, plan_target
    from jfto_world.motion.route_progress import RouteProgress

    plan_target(_POINTS, WpNav()).positions(np.zeros(1))
    fly_route(_POINTS[:2], WpNav())
    ArduCopter().leg_matrix(_POINTS, MotionLimits(5.0, 2.0, 2.0))
    ArduCopter().chain_times(_POINTS, MotionLimits(5.0, 2.0, 2.0))
    still = np.zeros((2, 3))
    RouteProgress(TimedTrajectory(0, np.array([0, 10**9]), still, still, still))
    warm_up()


def _network() -> None:
    from jfto_power import PowerProblem, allocate
    from jfto_topology import (
        Air,
        a_lmst,
        average_hops,
        connectivity_rate,
        cpapo,
        ctop,
        ctop_elastic,
    )

    radio, sensitivity_w, energy_j = Radio(), 1e-10, np.ones(4)
    channel, p_max_w = make_channel(radio), np.full(4, 1.0)
    positions = _POINTS[None].repeat(2, axis=0)
    top = ctop(positions, channel, p_max_w, sensitivity_w, 2, 0)
    gain = _gains(channel, positions)
    least_w, most_w = top.p_min_w, top.p_upper_w
    allocate(PowerProblem(top.adjacency, gain, least_w, most_w, energy_j, 1.0, radio))
    ctop_elastic(Air(gain, p_max_w, sensitivity_w, 1e-14), 2, 0)
    cpapo(positions, channel, p_max_w, sensitivity_w, energy_j, 1.0)
    a_lmst(positions, channel, p_max_w, sensitivity_w, energy_j, 1.0, 5.0 * np.ones(4))
    average_hops(top.adjacency)
    connectivity_rate(top.adjacency, 0)


def _gains(channel: Channel, positions_m: np.ndarray) -> np.ndarray:
    from jfto_world.radio import pairwise_distances

    return channel.gain(np.maximum(pairwise_distances(positions_m), 1.0))


def _problem() -> RoutingProblem:
    return RoutingProblem(
        waypoints_m=_POINTS,
        starts_m=_POINTS[:2] - [0.0, 0.0, 10.0],
        limits=(MotionLimits(5.0, 2.0, 2.0),) * 2,
        time_model=ConstantSpeed(),
        t_max_s=np.full(2, 100.0),
        reach_m=np.full(2, 1000.0),
        k_min=1,
        d_min_m=1.0,
        length_max_m=1e4,
        slot_count=10,
    )


def _routes() -> None:
    from jfto_planner.routing import SearchSettings, search

    search(_problem(), SearchSettings(moves=1, starts=1), seed=0)


def _curves() -> None:
    from jfto_planner.smoothing import CurveLimits, RouteRequest, smooth_route

    # Legs too short to reach cruise, so that their spline is tried too.
    limits = CurveLimits(speed_mps=10.0, climb_mps=4.0, descent_mps=3.0)
    smooth_route(RouteRequest(_POINTS / 4.0, limits))


def _learned_routes() -> None:
    from jfto_planner.policy.inference import ranked_routes
    from jfto_planner.policy.kernel.replay import fly_routes
    from jfto_planner.policy.problems import problems_of
    from jfto_planner.policy.weights import load_weights

    ranked_routes(load_weights(), _problem(), mode="greedy", most=1)
    fly_routes(problems_of(_problem()), np.full((1, 2, 1), len(_POINTS)))
