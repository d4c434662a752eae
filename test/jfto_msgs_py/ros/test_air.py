"""Reports of the air through their messages."""

import numpy as np
import pytest

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.records.air import AirReport
from jfto_msgs_py.ros import topics
from jfto_msgs_py.ros.air import decode_air, encode_air


def report():
    square = np.arange(4.0).reshape(2, 2)
    return AirReport(
        1763776800_250000000, ("uav1", "uav2"), np.array([0.5, 0.25]), np.array([3.0, 4.0]),
        square * 1e6, square / 8, square * 1e-9,
    )  # fmt: skip


def test_a_report_survives_its_messages():
    """All five arrays, UAVs and the stamp to the nanosecond; the labels describe themselves."""
    messages = encode_air(report())
    label = "uav;ids=uav1,uav2;t=1763776800.250000000"
    assert messages[topics.AIR_RATE].layout.dim[1].label == label
    back = decode_air(messages)
    assert (back.stamp_ns, back.uav_ids) == (1763776800_250000000, ("uav1", "uav2"))
    for name in ("power_w", "energy_j", "rate_bps", "delivery", "gain"):
        assert np.array_equal(getattr(back, name), getattr(report(), name))


def test_messages_that_do_not_belong_together_are_refused():
    """Another stamp on one topic, another fleet on one axis, a negative energy."""
    messages = encode_air(report())
    messages[topics.AIR_POWER].layout.dim[0].label = "uav;ids=uav1,uav2;t=1.0"
    with pytest.raises(MessageError, match="not the same on all topics"):
        decode_air(messages)
    messages = encode_air(report())
    messages[topics.AIR_GAIN].layout.dim[1].label = "uav;ids=uav2,uav1;t=1763776800.250000000"
    with pytest.raises(MessageError, match="other UAVs"):
        decode_air(messages)
    messages = encode_air(report())
    messages[topics.AIR_ENERGY].data = [-1.0, 0.0]
    with pytest.raises(MessageError, match="negative"):
        decode_air(messages)
