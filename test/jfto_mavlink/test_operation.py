"""How the bridge's parameters turn a plan into missions."""

from __future__ import annotations

import dataclasses

import pytest

from jfto_mavlink.errors import MissionError
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.operation import mission_settings
from jfto_mavlink.options import BridgeOptions


def test_a_plan_beyond_the_limits_given_makes_no_missions(plan) -> None:
    """Too far from home, too high above it: nothing is uploaded."""
    for options, words in (
        (BridgeOptions(distance_max_m=10.0), "m from home, at most 10 m"),
        (BridgeOptions(height_max_m=30.0), "height"),
    ):
        with pytest.raises(MissionError, match=words):
            build_missions(plan, mission_settings(plan, options))


def test_gates_need_times_that_vehicles_can_keep(plan) -> None:
    """Constant-speed times are too early: a late vehicle would wait a minute at its gate."""
    options = BridgeOptions(gates=(1,), start_at_s=1e9)
    with pytest.raises(MissionError, match=r"plan with trajectory\.mode waypoints"):
        mission_settings(plan, options)
    curved = dataclasses.replace(plan, time_model="bezier")
    assert mission_settings(curved, options).gates == (0,)


def test_gates_need_a_moment_of_lift_off(plan) -> None:
    """They are counted from it."""
    curved = dataclasses.replace(plan, time_model="bezier")
    with pytest.raises(MissionError, match="planned moment of lift-off"):
        mission_settings(curved, BridgeOptions(gates=(1,)))
