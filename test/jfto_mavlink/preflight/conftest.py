"""Cases of the checks: a mission of the two-UAV plan, and vehicles that say what a test wants."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.settings import MissionSettings
from jfto_mavlink.preflight.case import Case
from jfto_mavlink.preflight.facts import NAMES, Aboard, Snapshot
from jfto_mavlink.preflight.settings import GateSettings
from jfto_sim.parameters import definitions

DEFAULTS = {each.name: each.default for each in definitions()}


@pytest.fixture
def make_case(plan) -> Callable[..., Case]:
    """A case of uav1: `parameters` of the vehicle, `now` and `settings` that differ from fine."""
    mission = build_missions(plan, MissionSettings())[0]

    def make(parameters=(), now=(), settings=(), **aboard) -> Case:
        held = {n: DEFAULTS[n] for n in NAMES if n in DEFAULTS} | {"WPNAV_RADIUS": 200.0}
        snapshot = Snapshot(
            0.0, False, 6, 10, True, False, True, (), 0.0, mission.home_deg_m, 100, 12.6, 0.0
        )
        return Case(
            mission,
            replace(snapshot, **dict(now)),
            Aboard(held | dict(parameters), **aboard),
            replace(GateSettings(), **dict(settings)),
        )

    return make
