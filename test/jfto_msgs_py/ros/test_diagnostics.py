"""Diagnostics as messages and back."""

from __future__ import annotations

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.ros.diagnostics import (
    OK,
    STALE,
    Status,
    decode_diagnostics,
    encode_diagnostics,
)


def test_statuses_survive_the_way_through_a_message() -> None:
    """Node, stamp, UAVs, levels, texts and facts come back as they were."""
    statuses = (
        Status("", OK, "linked", {"flies": "uploaded missions"}),
        Status("uav1", STALE, "silent for 4.0 s"),
    )
    found = decode_diagnostics(encode_diagnostics("mavlink_bridge", 5_000_000_007, statuses))
    assert (found.node_name, found.stamp_ns) == ("mavlink_bridge", 5_000_000_007)
    assert found.statuses == statuses


def test_statuses_of_other_programs_are_refused() -> None:
    """/diagnostics is shared with everybody: two speakers in one array are none of ours."""
    message = DiagnosticArray(
        status=[DiagnosticStatus(name="joystick"), DiagnosticStatus(name="battery monitor")]
    )
    with pytest.raises(MessageError, match="speaks for 2 nodes"):
        decode_diagnostics(message)
    with pytest.raises(MessageError, match="speaks for 0 nodes"):
        decode_diagnostics(DiagnosticArray())
