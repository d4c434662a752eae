"""What a fleet learns about its channel."""

from __future__ import annotations

import numpy as np
import pytest

from jfto_world.radio import LogDistanceChannel, LossEstimate, pairwise_distances

CHANNEL = LogDistanceChannel(1e-4)
PLACES_M = np.random.default_rng(1).uniform(0, 1500, (8, 3))


def measured(loss_db, places_m=PLACES_M):
    """Gains (A, A) that such a loss leaves; `loss_db` is a number or (A, A)."""
    return CHANNEL.gain(pairwise_distances(places_m)) * 10 ** (-np.asarray(loss_db) / 10)


def test_before_anything_is_heard_the_channel_is_as_planned():
    """No loss, no spread; and neither from silence."""
    estimate = LossEstimate(CHANNEL)
    assert (estimate.loss_db, estimate.spread_db) == (0.0, 0.0)
    estimate.take(0, np.zeros((8, 8)), PLACES_M)
    assert (estimate.loss_db, estimate.spread_db) == (0.0, 0.0)


def test_a_common_loss_is_found_within_a_few_reports():
    """28 pairs that lose 3 dB outweigh the prior of one by the first report: 84 / 29 dB."""
    estimate = LossEstimate(CHANNEL)
    estimate.take(10**9, measured(3.0), PLACES_M)
    assert estimate.loss_db == pytest.approx(84 / 29, abs=0.01)
    for second in range(2, 12):
        estimate.take(second * 10**9, measured(3.0), PLACES_M)
    assert estimate.loss_db == pytest.approx(3.0, abs=0.02)
    assert estimate.spread_db == pytest.approx(0.0, abs=1e-6)


def test_the_spread_is_that_of_the_links():
    """Shadowing of 4 dB about a mean of 2 dB comes out as such."""
    rng = np.random.default_rng(2)
    estimate = LossEstimate(CHANNEL)
    for second in range(200):
        shadow = np.triu(2.0 + 4.0 * rng.standard_normal((8, 8)), 1)
        estimate.take(second * 10**9, measured(shadow + shadow.T), PLACES_M)
    assert estimate.loss_db == pytest.approx(2.0, abs=0.3)
    assert estimate.spread_db == pytest.approx(4.0, abs=0.3)


def test_old_measurements_are_forgotten():
    """After five times its memory the estimate follows a loss that has changed."""
    estimate = LossEstimate(CHANNEL, memory_s=10.0)
    estimate.take(0, measured(6.0), PLACES_M)
    estimate.take(50 * 10**9, measured(-2.0), PLACES_M)
    assert estimate.loss_db == pytest.approx(-2.0, abs=0.2)


def test_a_report_counts_once_and_none_goes_back():
    """The same stamp again, or an older one, changes nothing."""
    estimate = LossEstimate(CHANNEL)
    estimate.take(10**9, measured(3.0), PLACES_M)
    before = estimate.loss_db
    estimate.take(10**9, measured(9.0), PLACES_M)
    estimate.take(0, measured(9.0), PLACES_M)
    assert estimate.loss_db == before


def test_near_pairs_and_unheard_ones_do_not_count():
    """Where UAVs are 20 m apart, metres of position error would be decibels."""
    near = np.array([[0.0, 0.0, 0.0], [20.0, 0.0, 0.0], [800.0, 0.0, 0.0]])
    gain = measured(3.0, near)
    gain[0, 1] = gain[1, 0] = 1.0
    gain[1, 2] = gain[2, 1] = 0.0
    estimate = LossEstimate(CHANNEL)
    estimate.take(0, gain, near)
    # One pair of 3 dB and the prior of one at 0 dB.
    assert estimate.loss_db == pytest.approx(1.5)
