"""Every recorded observation has its place: tried as it stands, by hand, or left out knowingly."""

import re
from pathlib import Path

from rclpy_contract.coverage import BY_HAND, LEFT_OUT
from rclpy_contract.observations import RECORDED

_HERE = Path(__file__).parent
# Tried as they stand; the lines of "checked" replace those of other sections.
_AS_THEY_STAND = frozenset(
    [
        "names",
        "topics",
        "destroying",
        "context",
        "parameter_types",
        "declare",
        "get_set",
        "overrides",
        "qos",
        "qos_actual",
        "publishing",
        "constructor",
        "assignment",
        "checked",
        "array_defaults",
        "introspection",
        "serialization",
        "rosidl_runtime",
        "time",
        "clocks",
        "future",
        "cli",
        "precedence",
    ]
)


def _source():
    return "\n".join(path.read_text(encoding="utf-8") for path in _HERE.glob("test_*.py"))


def test_every_observation_has_a_place():
    """No observation is forgotten, and none has two places."""
    for section, items in RECORDED.items():
        by_hand = set(BY_HAND.get(section, {}))
        left_out = set(LEFT_OUT.get(section, {}))
        assert not by_hand & left_out, section
        assert by_hand | left_out <= set(range(len(items))), section
        if section not in _AS_THEY_STAND:
            missing = set(range(len(items))) - by_hand - left_out
            assert not missing, f"{section}: {sorted(missing)}"


def test_hand_written_tests_exist():
    """The tests that the list names are there."""
    defined = set(re.findall(r"^def (test_\w+)", _source(), re.MULTILINE))
    named = {test for tests in BY_HAND.values() for test in tests.values()}
    assert named <= defined, sorted(named - defined)


def test_reasons_are_given():
    """Whatever is left out says why."""
    assert all(reason for reasons in LEFT_OUT.values() for reason in reasons.values())
