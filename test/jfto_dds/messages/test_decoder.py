"""Malformed payloads are refused, at a cost no greater than their own size."""

import random
import struct
import tracemalloc

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_dds.messages.decoder import MalformedPayloadError, decode_message
from jfto_dds.messages.message_class import message_class

_TYPES = (
    "std_msgs/msg/String",
    "std_msgs/msg/Float64MultiArray",
    "geometry_msgs/msg/PoseStamped",
    "nav_msgs/msg/Path",
    "sensor_msgs/msg/NavSatFix",
    "diagnostic_msgs/msg/DiagnosticArray",
    "rcl_interfaces/msg/ParameterEvent",
    "trajectory_msgs/msg/MultiDOFJointTrajectory",
    "visualization_msgs/msg/MarkerArray",
)


def _try(payload, name):
    try:
        decode_message(payload, name)
    except MalformedPayloadError:
        return False
    return True


def test_ten_thousand_fuzzed_payloads(recorded_types):
    """Cut, flipped, lengthened and random payloads decode or raise one error, nothing else."""
    rng = random.Random(20261122)
    seeds = [
        (name, bytearray.fromhex(example["cdr"]))
        for name in _TYPES
        for example in recorded_types.get(name, {}).get("examples", [])
    ]
    refused = 0
    for number in range(10_000):
        name, valid = rng.choice(seeds)
        payload = bytearray(valid)
        kind = number % 4
        if kind == 0:
            payload = payload[: rng.randrange(len(payload))]
        elif kind == 1:
            for _ in range(rng.randrange(1, 9)):
                payload[rng.randrange(len(payload))] = rng.randrange(256)
        elif kind == 2 and len(payload) >= 8:
            at = rng.randrange(4, len(payload) - 3)
            payload[at : at + 4] = struct.pack("<I", rng.choice((2**32 - 1, 2**31, 10**6)))
        else:
            payload = bytearray(b"\0\1\0\0") + rng.randbytes(rng.randrange(64))
        refused += not _try(bytes(payload), rng.choice(_TYPES) if kind == 3 else name)
    assert refused > 2_000


def test_huge_lengths_allocate_nothing():
    """A sequence that claims four thousand million elements costs no memory."""
    payload = b"\0\1\0\0" + struct.pack("<III", 0, 0, 2**32 - 1)
    tracemalloc.start()
    with pytest.raises(MalformedPayloadError):
        decode_message(payload, "std_msgs/msg/Float64MultiArray")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 100_000


@given(st.binary(max_size=200), st.sampled_from(_TYPES))
@settings(deadline=None, max_examples=200)
def test_any_bytes(data, name):
    """Whatever the bytes, there is a message or the one error."""
    if _try(data, name):
        message = decode_message(data, name)
        assert isinstance(message, message_class(name))


def test_big_endian_payloads_are_read():
    """The byte order is in the encapsulation header."""
    body = struct.pack(">I", 3) + b"ab\0"
    assert decode_message(b"\0\0\0\0" + body, "std_msgs/msg/String").data == "ab"
    body = struct.pack(">III4xd", 0, 0, 1, 1.5)
    message = decode_message(b"\0\0\0\0" + body, "std_msgs/msg/Float64MultiArray")
    assert list(message.data) == [1.5]


def test_bounds_hold():
    """A bounded sequence does not take more than its bound."""
    name = "rcl_interfaces/msg/ParameterDescriptor"
    support = message_class(name)._TYPE_SUPPORT
    payload = bytearray(support.serialize(message_class(name)()))
    payload[-4:] = struct.pack("<I", 2)
    with pytest.raises(MalformedPayloadError, match="bounded to 1"):
        decode_message(bytes(payload) + bytes(64), name)
