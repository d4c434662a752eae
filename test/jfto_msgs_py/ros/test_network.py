"""Adjacency, intervals and schedules through their messages."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.records.network import Adjacency, PowerIntervals, PowerSchedule, SlotHorizon
from jfto_msgs_py.ros.network import (
    decode_adjacency,
    decode_power_intervals,
    decode_power_schedule,
    encode_adjacency,
    encode_power_intervals,
    encode_power_schedule,
)

horizons = st.builds(
    SlotHorizon,
    first=st.integers(0, 10**6),
    t0_ns=st.integers(0, 4 * 10**18),
    duration_s=st.floats(1e-3, 1e3),
    count=st.integers(1, 5),
)
fleets = st.lists(
    st.text("abcxyz0189_", min_size=1, max_size=6), min_size=1, max_size=5, unique=True
).map(tuple)


@settings(deadline=None, max_examples=40)
@given(horizons, fleets, st.integers(0, 2**32 - 1))
def test_every_record_survives_its_message(horizon, uav_ids, seed) -> None:
    """Decoding what was encoded gives the same horizon, to the nanosecond, UAVs and values."""
    rng = np.random.default_rng(seed)
    shape = (horizon.count, len(uav_ids))
    upper = np.triu(rng.random((*shape, len(uav_ids))) < 0.5, 1)
    links = Adjacency(horizon, uav_ids, upper | np.swapaxes(upper, 1, 2))
    back = decode_adjacency(encode_adjacency(links))
    assert (back.horizon, back.uav_ids) == (horizon, uav_ids)
    assert np.array_equal(back.links, links.links)
    bounds = np.sort(rng.random((*shape, 2)), axis=-1)
    intervals = decode_power_intervals(
        encode_power_intervals(PowerIntervals(horizon, uav_ids, bounds))
    )
    assert (intervals.horizon, intervals.uav_ids) == (horizon, uav_ids)
    assert np.array_equal(intervals.bounds_w, bounds)
    schedule = decode_power_schedule(
        encode_power_schedule(PowerSchedule(horizon, uav_ids, bounds[..., 0]))
    )
    assert (schedule.horizon, schedule.uav_ids) == (horizon, uav_ids)
    assert np.array_equal(schedule.power_w, bounds[..., 0])


def _intervals():
    horizon = SlotHorizon(45, 1763776800250000000, 3.0, 2)
    bounds = np.array([[[0.1, 0.2], [0.3, 0.4]], [[0.1, 0.2], [0.3, 0.4]]])
    return encode_power_intervals(PowerIntervals(horizon, ("uav1", "uav2"), bounds))


def test_labels_read_as_documented() -> None:
    """The dimension labels are the ones that other programs are told to parse."""
    assert [dim.label for dim in _intervals().layout.dim] == [
        "slot;first=45;t0=1763776800.250000000;dt=3.0",
        "uav;ids=uav1,uav2",
        "bound;min,max;unit=W",
    ]
    assert [dim.stride for dim in _intervals().layout.dim] == [8, 4, 2]


def _label(axis: int, text: str):
    def spoil(message) -> None:
        message.layout.dim[axis].label = text

    return spoil


def _value(index: int, value: float):
    def spoil(message) -> None:
        message.data[index] = value

    return spoil


def _drop_value(message) -> None:
    message.data = list(message.data)[:-1]


def _drop_dimension(message) -> None:
    message.layout.dim = list(message.layout.dim)[:-1]


def _stride(message) -> None:
    message.layout.dim[0].stride = 7


def _offset(message) -> None:
    message.layout.data_offset = 3


def _huge(message) -> None:
    message.layout.dim[0].size = 2**32 - 1


@pytest.mark.parametrize(
    ("spoil", "field"),
    [
        (_drop_value, "data"),
        (_drop_dimension, "layout.dim"),
        (_stride, "stride"),
        (_offset, "data_offset"),
        (_huge, "data"),
        (_label(0, "slots;first=1;t0=0.0;dt=1.0"), "layout.dim.label"),
        (_label(0, "slot;first=1;t0=0.0"), "layout.dim.label"),
        (_label(0, "slot;first=one;t0=0.0;dt=1.0"), "slot.first"),
        (_label(0, "slot;first=-1;t0=0.0;dt=1.0"), "slot.first"),
        (_label(0, "slot;first=1;t0=-2.0;dt=1.0"), "slot.t0"),
        (_label(0, "slot;first=1;t0=1e9;dt=1.0"), "slot.t0"),
        (_label(0, "slot;first=1;t0=0.0;dt=nan"), "slot.dt"),
        (_label(0, "slot;first=1;t0=0.0;dt=0"), "slot.dt"),
        (_label(1, "uav;ids=uav1"), "uav.ids"),
        (_label(1, "uav;ids=uav1,uav1"), "uav.ids"),
        (_label(1, "uav;ids=uav1,"), "uav.ids"),
        (_label(2, "bound;max,min;unit=W"), "layout.dim[2].label"),
        (_value(0, float("nan")), "power_interval.data"),
        (_value(0, -0.1), "power_interval.data"),
        (_value(0, 0.5), "power_interval.data"),
    ],
)
def test_a_malformed_message_names_its_field(spoil, field) -> None:
    """Whatever contradicts the contract raises MessageError with the part at fault."""
    message = _intervals()
    spoil(message)
    with pytest.raises(MessageError) as caught:
        decode_power_intervals(message)
    assert field in caught.value.field


def test_adjacency_must_be_symmetric_and_binary() -> None:
    """One-way links, self links and values other than 0 and 1 are refused."""
    horizon = SlotHorizon(0, 0, 1.0, 1)
    links = np.zeros((1, 2, 2), dtype=bool)
    for index, value in ((1, 1), (0, 1), (1, 2)):
        message = encode_adjacency(Adjacency(horizon, ("a", "b"), links))
        message.data[index] = value
        with pytest.raises(MessageError, match="data"):
            decode_adjacency(message)
