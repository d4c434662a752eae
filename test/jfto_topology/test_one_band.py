"""What one channel carries, against every set of transmissions."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.radio import Radio
from jfto_topology.one_band import one_band
from jfto_world.radio import noise_w

RADIO = Radio(bandwidth_hz=1.0, noise_dbm=-60.0)


def test_pairs_far_apart_send_at_once_and_near_ones_in_turn():
    """Two pairs: 60 dB between them and both count, 3 dB and one alone does."""
    linked = np.zeros((2, 4, 4), dtype=bool)
    for a, b in ((0, 1), (2, 3)):
        linked[:, a, b] = linked[:, b, a] = True
    gain = np.where(linked, 1e-5, 0.0)
    gain[0] += ~linked[0] * 1e-11
    gain[1] += ~linked[1] * 5e-6
    found = one_band(linked, gain, np.ones((2, 4)), RADIO)
    assert found.at_once.tolist() == [2, 1]
    alone = np.log2(1 + 1e-5 / noise_w(RADIO))
    assert found.throughput_bps == pytest.approx([2 * alone, alone], rel=1e-2)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.integers(2, 5), st.integers(0, 2**32 - 1), st.sampled_from([0.0, 3.0, 10.0]))
def test_it_is_the_best_of_all_sets(uavs, seed, sinr_db):
    """Every set of transmissions without a common end is tried."""
    rng = np.random.default_rng(seed)
    gain = 10 ** rng.uniform(-9, -4, (1, uavs, uavs))
    gain = np.triu(gain[0], 1)[None]
    gain = gain + gain.transpose(0, 2, 1)
    linked = (rng.uniform(size=gain.shape) < 0.6) & (gain > 0)
    linked |= linked.transpose(0, 2, 1)
    power = rng.uniform(0.1, 1, (1, uavs))
    found = one_band(linked, gain, power, RADIO, sinr_db)
    ways = np.argwhere(linked[0]).tolist()
    best = 0.0
    for size in range(1, uavs // 2 + 1):
        for chosen in combinations(ways, size):
            ends = [end for way in chosen for end in way]
            if len(set(ends)) < len(ends):
                continue
            bits = 0.0
            for a, b in chosen:
                others = sum(power[0, c] * gain[0, c, b] for c, _ in chosen if c != a)
                ratio = power[0, a] * gain[0, a, b] / (noise_w(RADIO) + others)
                bits = -np.inf if ratio < 10 ** (sinr_db / 10) else bits + np.log2(1 + ratio)
            best = max(best, bits)
    assert found.throughput_bps == pytest.approx([best])


def test_shapes_that_do_not_fit_are_refused():
    """The message has all of them."""
    links = np.zeros((1, 2, 2), dtype=bool)
    with pytest.raises(InputError, match=r"power_w \(1, 3\)"):
        one_band(links, np.zeros((1, 2, 2)), np.ones((1, 3)), RADIO)
