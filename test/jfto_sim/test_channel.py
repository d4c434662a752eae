"""Knife edges, packet delivery and slow errors."""

import numpy as np

from jfto_sim.channel import delivery_share, knife_edge_loss_db, terrain_loss_db
from support.slow_error import SlowError


def test_knife_edge_has_the_figures_of_the_recommendation():
    """J(0) = 6.0 dB at grazing, J(1) = 13.9 dB, J(2.4) = 20.5 dB, nothing with a clear zone."""
    loss = knife_edge_loss_db(np.array([0.0, 1.0, 2.4, -0.78, -3.0]))
    assert np.allclose(loss, [6.03, 13.93, 20.54, 0.0, 0.0], atol=0.05)


def test_a_ridge_attenuates_only_what_passes_behind_it():
    """A wall at 500 m east stands between the first two UAVs and beside the third."""

    def wall(east, north):
        return np.where((abs(east - 500) < 10) & (north < 100), 150.0, 0.0)

    at = np.array([[0.0, 0.0, 100.0], [1000.0, 0.0, 100.0], [1000.0, 800.0, 400.0]])
    loss = terrain_loss_db(at, wall, 2.44e9)
    # ν = 50 m × sqrt(2 · 1000 m / (0.123 m · 500 m · 500 m)) = 12.76: 6.9 + 20 lg 25.3 = 35 dB.
    assert abs(loss[0, 1] - 35.0) < 0.2
    assert loss[1, 2] == loss[0, 2] == 0.0
    assert np.array_equal(loss, loss.T)


def test_delivery_is_nine_tenths_at_the_sensitivity():
    """0.9 at 0 dB, half at -2.2 dB, all far above, none from a silent radio."""
    share = delivery_share(np.array([0.0, -np.log(9.0), 60.0, -1e6, -np.inf]))
    assert np.allclose(share, [0.9, 0.5, 1.0, 0.0, 0.0])


def test_slow_errors_have_their_spread_and_do_not_jump():
    """σ over many channels and times; a hundredth of a period changes little; seeded."""
    error = SlowError(400, sigma=2.0, period_s=60.0, seed=5)
    values = np.array([error.at(t) for t in np.arange(0, 3000, 150.0)])
    assert abs(values.std() - 2.0) < 0.1
    assert abs(error.at(100.6) - error.at(100.0)).max() < 0.3
    assert np.array_equal(SlowError(3, 1.0, 9.0, 1).at(4.0), SlowError(3, 1.0, 9.0, 1).at(4.0))
