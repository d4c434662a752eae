"""Path gain of links."""

from __future__ import annotations

import numpy as np
import pytest

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.radio import Radio
from jfto_world.radio import make_channel


def test_gain_falls_with_the_square_and_needs_a_length() -> None:
    """Ten times as far is 20 dB less; unknown stays unknown; a length below 0 is refused."""
    channel = make_channel(Radio())
    near, far, unknown = channel.gain(np.array([100.0, 1000.0, np.nan]))
    assert near / far == pytest.approx(100.0)
    assert np.isnan(unknown)
    with pytest.raises(InputError, match="holds -1 m; lengths of links are 0 or more"):
        channel.gain(np.array([5.0, -1.0, np.nan]))
