"""Cutting frames out of noise."""

from __future__ import annotations

import random

from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.io.framing import Framer


def frames(count: int, *, seed: int = 0) -> list[bytes]:
    codec = mavlink.MAVLink(None, 1, 1)
    rng = random.Random(seed)
    made = []
    for _ in range(count):
        message = mavlink.MAVLink_command_long_message(
            1, 1, rng.randrange(400), 0, *(rng.uniform(-9, 9) for _ in range(7))
        )
        made.append(message.pack(codec, force_mavlink1=rng.random() < 0.3))
        codec.seq = (codec.seq + 1) % 256
    return made


@settings(max_examples=60, deadline=None, derandomize=True)
@given(cuts=st.lists(st.integers(1, 40), min_size=1, max_size=60), data=st.data())
def test_every_frame_is_found_however_the_stream_is_cut(cuts, data):
    """Frames come out once, in order, whatever the chunks and the noise between them."""
    wanted = frames(12)
    # Bytes that start no frame cannot swallow one.
    noise = st.binary(max_size=20).map(lambda b: b.replace(b"\xfd", b"").replace(b"\xfe", b""))
    stream = b"".join(data.draw(noise) + raw for raw in wanted)
    framer, found, at, index = Framer(), [], 0, 0
    while at < len(stream):
        step = cuts[index % len(cuts)]
        found += [frame.raw for frame in framer.feed(stream[at : at + step])]
        at, index = at + step, index + 1
    assert found == wanted


def test_boot_text_between_frames_is_skipped():
    """The autopilot prints plain text between its first frames."""
    first, second = frames(2)
    framer = Framer()
    stream = (
        first + b"\r\n\r\nInit ArduCopter V4.5.5 (142aece2)\r\n\r\nFree RAM: 263256\r\n" + second
    )
    assert [frame.raw for frame in framer.feed(stream)] == [first, second]


def test_a_false_start_does_not_swallow_the_frames_behind_it():
    """After a corrupt frame, search goes on one byte later, not one frame later."""
    good = frames(20)
    framer = Framer()
    found = [f.raw for f in framer.feed(b"\xfd\xff\x00" + b"".join(good))]
    assert found[-1] == good[-1]
    assert len(found) == 20
    assert framer.noise_bytes == 3


def test_frames_with_unknown_incompatible_flags_are_dropped():
    """A receiver must drop what uses a feature it does not know (MAVLink guide)."""
    raw = bytearray(frames(1)[0])
    assert raw[0] == 0xFD
    raw[2] = 0x02
    framer = Framer()
    assert list(framer.feed(bytes(raw))) == []
    assert framer.bad_frames == 1


def test_ten_thousand_malformed_frames_do_no_harm():
    """Random bytes and mutated frames raise nothing, leave nothing behind, and good ones pass."""
    rng = random.Random(7)
    framer = Framer()
    base = frames(50, seed=1)
    for _ in range(10_000):
        raw = bytearray(rng.choice(base))
        for _ in range(rng.randint(1, 6)):
            raw[rng.randrange(len(raw))] = rng.randrange(256)
        chunk = bytes(raw) if rng.random() < 0.7 else rng.randbytes(rng.randint(1, 300))
        list(framer.feed(chunk))
        assert len(framer._buffer) <= 280
    good = frames(10, seed=2)
    found = [frame.raw for frame in framer.feed(b"\0" * 300 + b"".join(good))]
    assert found[-9:] == good[-9:]
