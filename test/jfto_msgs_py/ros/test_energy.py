"""Energy left through its message."""

from __future__ import annotations

import pytest

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.ros.air import decode_energy_left, encode_energy_left


def test_energy_left_survives_its_message() -> None:
    """UAVs, joules, and the stamp in the label."""
    message = encode_energy_left(1763776800_250000001, {"uav1": 12.5, "uav3": 0.0})
    assert message.layout.dim[0].label == "uav;ids=uav1,uav3;t=1763776800.250000001"
    assert decode_energy_left(message) == {"uav1": 12.5, "uav3": 0.0}


def test_energy_that_is_none_is_refused() -> None:
    """Below zero is an overdraft that no account has."""
    message = encode_energy_left(1, {"uav1": 1.0})
    message.data = [-1.0]
    with pytest.raises(MessageError, match="negative"):
        decode_energy_left(message)
