"""Which mission items the autopilot accepts, with which code it refuses, and what it keeps."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_sim.dialect import mavlink as m
from jfto_sim.mission.items import parse

NAN, INF = math.nan, math.inf


def item(command=16, frame=6, params=(0, 0, 0, 0), x=473977420, y=85455940, z=20.0):
    return m.MAVLink_mission_item_int_message(1, 1, 2, frame, command, 0, 1, *params, x, y, z, 0)


REFUSED = [
    (item(31000), m.MAV_MISSION_UNSUPPORTED),
    (item(81), m.MAV_MISSION_UNSUPPORTED),
    (item(195), m.MAV_MISSION_UNSUPPORTED),
    (item(197), m.MAV_MISSION_UNSUPPORTED),
    (item(0), m.MAV_MISSION_INVALID),
    (item(frame=1), m.MAV_MISSION_UNSUPPORTED_FRAME),
    (item(frame=12), m.MAV_MISSION_UNSUPPORTED_FRAME),
    (item(params=(NAN, 0, 0, 0)), m.MAV_MISSION_INVALID_PARAM1),
    (item(params=(0, INF, 0, 0)), m.MAV_MISSION_INVALID_PARAM2),
    (item(params=(0, 0, NAN, 0)), m.MAV_MISSION_INVALID_PARAM3),
    (item(178, params=(0, 0, 0, NAN)), m.MAV_MISSION_INVALID_PARAM4),
    (item(x=910000000), m.MAV_MISSION_INVALID_PARAM5_X),
    (item(x=-910000000), m.MAV_MISSION_INVALID_PARAM5_X),
    (item(y=1810000000), m.MAV_MISSION_INVALID_PARAM6_Y),
    (item(z=NAN), m.MAV_MISSION_INVALID_PARAM7),
    (item(z=83000.0), m.MAV_MISSION_INVALID_PARAM7),
]


@pytest.mark.parametrize(("message", "code"), REFUSED)
def test_refused(message, code):
    """Each bad item has its own code."""
    assert parse(message) == (None, code)


ACCEPTED = [
    item(params=(0, 0, 0, NAN)),
    item(22, params=(0, 0, 0, NAN)),
    item(z=-50.0),
    item(z=-1000.0),
    item(params=(-1, 0, 0, 0)),
    item(84),
    item(x=900000000),
    item(y=1800000000),
]


@pytest.mark.parametrize("message", ACCEPTED)
def test_accepted(message):
    """What looks odd and is taken all the same."""
    found, code = parse(message)
    assert code == 0
    assert found is not None


KEPT = [
    (item(params=(2.7, 3.3, 1.5, 123.4), z=20.123), (2, 0, 0, 0), 3, 20.12),
    (item(params=(70000, 0, 0, 0)), (4464, 0, 0, 0), 3, 20.0),
    (item(178, 2, (1, 5.55, -1, 0)), (1, pytest.approx(5.55), -1, 0), 0, 0.0),
    (item(19, params=(12.5, 0, 0, 0)), (12, 0, 1, 0), 3, 20.0),
    (item(18, params=(2, 0, 15.5, 0)), (2, 0, 15, 0), 3, 20.0),
    (item(18, params=(2, 0, 300, 0)), (2, 0, 300, 0), 3, 20.0),
    (item(21), (0, 0, 0, 1), 3, 20.0),
    (item(93, 2, (5.5, -1, -1, -1)), (5.5, -1, -1, -1), 0, 0.0),
    (item(115, 2, (45.5, 10.5, 1, 1)), (45.5, 10.5, 1, 1), 0, 0.0),
    (item(frame=5), (0, 0, 0, 0), 0, 20.0),
    (item(frame=11), (0, 0, 0, 0), 10, 20.0),
]


@pytest.mark.parametrize(("message", "params", "frame", "height"), KEPT)
def test_kept(message, params, frame, height):
    """What survives storage: whole seconds, centimetres, frames without INT."""
    found, _ = parse(message)
    assert found.params == params
    assert found.frame == frame
    assert found.z_m == pytest.approx(height, abs=1e-6)


@given(
    command=st.integers(0, 65535),
    frame=st.integers(0, 255),
    floats=st.lists(st.floats(width=32), min_size=5, max_size=5),
    x=st.integers(-(2**31), 2**31 - 1),
    y=st.integers(-(2**31), 2**31 - 1),
)
@settings(deadline=None, max_examples=200, derandomize=True)
def test_any_item_is_stored_or_refused(command, frame, floats, x, y):
    """No item breaks the parser: it is kept with finite values, or refused with a code."""
    found, code = parse(item(command, frame, floats[:4], x, y, floats[4]))
    assert (found is None) == (code != 0)
    if found is not None and command not in (16, 21, 22, 84, 85):
        assert all(math.isfinite(p) for p in found.params)
