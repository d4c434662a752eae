"""The fleet's word that a flight began says of which plan."""

from __future__ import annotations

import pytest

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.ros.lift_off import decode_lift_off, encode_lift_off, lift_off_of
from jfto_msgs_py.ros.stamps import encode_time

BEGUN_NS = 1_763_776_800_250_000_000


def test_it_names_the_plan_and_the_moment() -> None:
    """To the nanosecond, with the tag."""
    message = encode_lift_off(BEGUN_NS, "ab12")
    assert decode_lift_off(message) == (BEGUN_NS, "ab12")
    assert lift_off_of(message, "ab12") == BEGUN_NS


@pytest.mark.parametrize("told", ["cd34", ""])
def test_that_of_another_plan_is_refused(told: str) -> None:
    """Also one that names no plan; with the cure."""
    with pytest.raises(MessageError, match=r"another plan.*ROS_DOMAIN_ID"):
        lift_off_of(encode_lift_off(BEGUN_NS, told), "ab12")


def test_older_recordings_hold_a_time() -> None:
    """It names no plan, and is read all the same."""
    assert decode_lift_off(encode_time(BEGUN_NS)) == (BEGUN_NS, "")
