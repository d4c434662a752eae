"""Powers of a horizon against the energy that is left."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.records.network import Adjacency, PowerIntervals, SlotHorizon
from jfto_msgs_py.records.radio import Radio
from jfto_power.horizon import HorizonRules, plan_horizon
from jfto_world.radio import make_channel
from support.fleets import at

RADIO = Radio()
IDS = ("uav1", "uav2")
HORIZON = SlotHorizon(6, at(12.0), 2.0, 5)
POSITIONS = np.tile(np.array([[0.0, 0, 0], [300.0, 0, 0]]), (5, 1, 1))


def _plan(
    left_j: float | dict[str, float],
    slot_count: int = 10,
    intervals_of: SlotHorizon = HORIZON,
    reserve: float = 0.0,
):
    links = np.tile(~np.eye(2, dtype=bool), (5, 1, 1))
    bounds = np.tile(np.array([0.1, 0.5]), (5, 2, 1))
    return plan_horizon(
        Adjacency(HORIZON, IDS, links),
        PowerIntervals(intervals_of, IDS, bounds),
        POSITIONS,
        left_j if isinstance(left_j, dict) else dict.fromkeys(IDS, left_j),
        HorizonRules(slot_count, make_channel(RADIO), RADIO, reserve),
    )


def test_every_slot_of_the_horizon_costs_energy() -> None:
    """Five slots of 2 s to the end of the mission share 3 J: 0.3 W each, the current one too."""
    power = _plan(3.0).schedule.power_w
    np.testing.assert_allclose(power, 0.3, rtol=1e-9)


def test_a_horizon_short_of_the_end_saves_its_share() -> None:
    """With 25 slots left, five of them may use a fifth of 15 J."""
    power = _plan(15.0, slot_count=30).schedule.power_w
    np.testing.assert_allclose(power.sum(axis=0) * 2.0, 3.0, rtol=1e-9)


def test_a_reserve_is_kept_back_from_all_but_the_least_powers() -> None:
    """A tenth of 3 J leaves 0.27 W in each slot; least powers of 1 J are paid from 1.05 J."""
    np.testing.assert_allclose(_plan(3.0, reserve=0.1).schedule.power_w, 0.27, rtol=1e-9)
    tight = _plan(1.05, reserve=0.1)
    assert tight.shortage is None
    np.testing.assert_allclose(tight.schedule.power_w, 0.1, rtol=1e-9)


def test_the_least_powers_come_before_saving() -> None:
    """When the share would not pay for the floor, the floor is paid as long as it can be."""
    planned = _plan(1.2, slot_count=30)
    assert planned.shortage is None
    np.testing.assert_allclose(planned.schedule.power_w, 0.1)


def test_a_shortage_holds_the_longest_prefix() -> None:
    """0.5 J pays for two slots at 0.1 W; the rest is silence, and the shortage says who."""
    planned = _plan(0.5)
    assert planned.shortage is not None
    assert planned.shortage.uavs == (0, 1)
    power = planned.schedule.power_w
    assert (power[:2] >= 0.1).all()
    assert (power[2:] == 0).all()
    assert (power.sum(axis=0) * 2.0 <= 0.5 + 1e-12).all()


def test_one_uav_short_of_energy_does_not_silence_the_fleet() -> None:
    """uav1 can pay for two slots; uav2 goes on to the end of its own budget."""
    planned = _plan({"uav1": 0.5, "uav2": 3.0})
    assert planned.shortage is not None
    assert planned.shortage.uavs == (0,)
    power = planned.schedule.power_w
    assert (power[2:, 0] == 0).all()
    assert (power[:, 1] >= 0.1).all()
    assert (power.sum(axis=0) * 2.0 <= np.array([0.5, 3.0]) + 1e-12).all()


def test_on_the_way_home_the_least_powers_are_all_that_is_spent() -> None:
    """From slot N on there is no telling how long it takes."""
    power = _plan(3.0, slot_count=6).schedule.power_w
    np.testing.assert_allclose(power, 0.1, rtol=1e-9)


def test_messages_of_two_horizons_are_not_mixed() -> None:
    """An interval of another slot is refused."""
    with pytest.raises(MessageError, match="same horizon"):
        _plan(3.0, intervals_of=replace(HORIZON, first=7))
