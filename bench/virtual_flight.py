"""A plan flown in virtual time through the simulator's air, whoever sets the powers."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "test"))

from jfto_msgs_py.records.air import AirReport
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.units import w_to_dbm
from jfto_planner.plan_trajectory import timed_trajectories
from jfto_sim.air import Air, AirMember, AirSettings
from jfto_topology.metrics import components, connectivity_rate
from jfto_world.motion.progress import sample
from jfto_world.radio import degrees
from support.slow_error import SlowError

START_NS = 1_763_776_800 * 10**9
STEPS_PER_SLOT = 5
# Errors swing with periods from this to five times as long.
DRIFT_S = 60.0


@dataclass(frozen=True)
class Errors:
    """Standard deviations of position (m per axis) and time (s), and loss beyond the plan (dB)."""

    position_m: float = 0.0
    time_s: float = 0.0
    loss_db: float = 0.0


@dataclass(frozen=True)
class Score:
    """What one flight achieved: mean network throughput, ξ from slot 45 on, shares of violations.

    `below` is the share of UAVs and moments with fewer than K_min links, `apart` that of moments
    with a fleet in parts, `overdrawn` the number of UAVs that ran out of energy for sending before
    the last look: to have spent all by then is what is best.
    """

    mbps: float
    xi: float
    below: float
    apart: float
    overdrawn: int


class Pilot(Protocol):
    """Who sets the powers."""

    def powers(
        self, now_ns: int, poses_m: np.ndarray, heard: AirReport
    ) -> Mapping[str, float] | None:
        """Powers in W from now on; None: as they are. Poses (A, 3) are as measured."""


class World:
    """What truly happens to the fleet, from a seed.

    Each vehicle runs off its route by an error of the given spread, and late or early by one;
    what it reports is off the truth by another of the same spread as the first.
    """

    def __init__(self, plan: Plan, errors: Errors, seed: int) -> None:
        ids = [uav.id for uav in plan.uavs]
        seeds = np.random.SeedSequence(seed).generate_state(4).tolist()
        routes = timed_trajectories(plan, START_NS)
        lag = SlowError(len(ids), errors.time_s, DRIFT_S, seeds[0])
        shape = (-1, len(ids), 2)
        self.times_s = np.arange(plan.slots.count * STEPS_PER_SLOT) * self.step_s(plan)
        late_s = np.stack([lag.at(time) for time in self.times_s])
        self.places_m = np.stack(
            [
                sample(route.offset_ns / 1e9, route.position_m, self.times_s - late_s[:, index])
                for index, route in enumerate(routes[uav] for uav in ids)
            ],
            axis=1,
        )
        off, misread = (
            SlowError(2 * len(ids), errors.position_m, DRIFT_S, number) for number in seeds[1:3]
        )
        self.places_m[..., :2] += np.stack([off.at(t) for t in self.times_s]).reshape(shape)
        self.poses_m = self.places_m.copy()
        self.poses_m[..., :2] += np.stack([misread.at(t) for t in self.times_s]).reshape(shape)
        self.plan = plan
        self._members = [AirMember(uav.id, uav.p_max_dbm, uav.energy_j) for uav in plan.uavs]
        self._settings = AirSettings(path_loss_error_db=errors.loss_db, seed=seeds[3])

    def air(self) -> Air:
        """The air before the flight."""
        return Air(self._members, self.plan.radio, self._settings)

    @staticmethod
    def step_s(plan: Plan) -> float:
        """Seconds between two looks."""
        return plan.slots.duration_s / STEPS_PER_SLOT


def fly(world: World, pilot: Pilot, n_dc: int) -> Score:
    """One flight; every pilot meets the same world."""
    plan, air = world.plan, world.air()
    step_s = world.step_s(plan)
    # On the pads the radios are on and hear each other.
    report = air.step(0.0, world.places_m[0], metered=False, stamp_ns=START_NS - 10**9)
    reports, overdrawn = [], 0
    for now_s, places_m, poses_m in zip(world.times_s, world.places_m, world.poses_m, strict=True):
        now_ns = START_NS + round(now_s * 1e9)
        for uav, watt in (pilot.powers(now_ns, poses_m, report) or {}).items():
            air.set_power(uav, float(w_to_dbm(watt)))
        overdrawn = int((air.left_j <= 0).sum())
        report = air.step(step_s, places_m, stamp_ns=now_ns)
        reports.append(report)
    links = np.stack([report.links for report in reports])
    on_air = np.stack([report.power_w > 0 for report in reports])
    part = components(links, np.ones(on_air.shape, dtype=bool))
    return Score(
        float(np.mean([report.throughput_bps for report in reports]) / 1e6),
        connectivity_rate(links, n_dc * STEPS_PER_SLOT, on_air),
        float((degrees(links) < plan.k_min).mean()),
        float((part.max(axis=1) > 0).mean()),
        overdrawn,
    )
