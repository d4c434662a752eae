"""Shadowing: spread, correlation, reciprocity, seed."""

import numpy as np
import pytest

from jfto_msgs_py.errors import InputError
from jfto_sim.channel import AirSettings, Shadowing


def walk(settings, steps, step_m, dt_s=0.0, uavs=12):
    """Losses (steps, pairs) of a fleet that moves east in equal steps."""
    shadowing = Shadowing(uavs, settings)
    pairs = np.triu_indices(uavs, 1)
    at = np.zeros((uavs, 3))
    losses = []
    for _ in range(steps):
        losses.append(shadowing.step(dt_s, at)[pairs])
        at[:, 0] += step_m
    return np.array(losses)


def test_spread_is_sigma_however_often_one_looks():
    """The standard deviation is σ for fine and for coarse steps."""
    fine = walk(AirSettings(shadowing_sigma_db=6.0, seed=1), 4000, 5.0)
    coarse = walk(AirSettings(shadowing_sigma_db=6.0, seed=2), 4000, 80.0)
    assert abs(fine.std() - 6.0) < 0.3
    assert abs(coarse.std() - 6.0) < 0.1


def test_correlation_falls_with_the_motion_of_both_ends():
    """Two ends that move 25 m each keep e^-0.5 over a decorrelation distance of 100 m."""
    loss = walk(AirSettings(shadowing_sigma_db=4.0, seed=3), 6000, 25.0)
    kept = np.mean(loss[1:] * loss[:-1]) / np.mean(loss**2)
    assert abs(kept - np.exp(-0.5)) < 0.02


def test_a_hovering_fleet_decorrelates_in_time():
    """Without motion e^-1 is kept over the decorrelation time."""
    settings = AirSettings(shadowing_sigma_db=4.0, shadowing_decorrelation_s=30.0, seed=4)
    loss = walk(settings, 6000, 0.0, dt_s=30.0)
    kept = np.mean(loss[1:] * loss[:-1]) / np.mean(loss**2)
    assert abs(kept - np.exp(-1.0)) < 0.02


def test_both_directions_lose_the_same_and_a_seed_decides_all():
    """The loss is reciprocal; same seed and looks, same bytes; another seed, another loss."""
    at = np.random.default_rng(0).uniform(0, 900, (5, 3))
    first, again, other = (
        Shadowing(5, AirSettings(shadowing_sigma_db=3.0, seed=seed)).step(1.0, at)
        for seed in (7, 7, 8)
    )
    assert np.array_equal(first, first.T)
    assert first.tobytes() == again.tobytes()
    assert not np.array_equal(first, other)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("path_loss_error_db", float("nan")),
        ("shadowing_sigma_db", -1.0),
        ("shadowing_decorrelation_m", 0.0),
        ("shadowing_decorrelation_s", -3.0),
    ],
)
def test_settings_that_make_no_sense_are_named(name, value):
    """The message names the setting and its value."""
    with pytest.raises(InputError) as caught:
        AirSettings(**{name: value})
    assert f"{name} is {value}" in str(caught.value)
