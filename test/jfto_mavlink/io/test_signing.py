"""MAVLink 2 signing against frames that a real autopilot signed or refused."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path

import pytest

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import SigningError
from jfto_mavlink.files.tlog import read_tlog
from jfto_mavlink.io.framing import Frame, Framer
from jfto_mavlink.io.port import Station
from jfto_mavlink.io.signing import (
    EPOCH_S,
    TICKS_PER_S,
    Signer,
    StampFile,
    create_key,
    read_key,
    ticks,
)

DATA = Path(__file__).parents[2] / "data" / "ardupilot"
KEY = hashlib.sha256(b"test key one").digest()
NOW_S = EPOCH_S + 400_000_000.0


def make_signer(clock: Callable[[], float] = lambda: NOW_S, **extra) -> Signer:
    return Signer(KEY, clock, **extra)


def signed(signer: Signer, system: int = 1, link: int = 0, stamp: int | None = None) -> bytes:
    codec = mavlink.MAVLink(None, system, 1)
    signer.prepare(codec, link)
    if stamp is not None:
        codec.signing.timestamp = stamp
    return mavlink.MAVLink_heartbeat_message(2, 3, 81, 0, 3, 3).pack(codec)


@pytest.fixture
def recorded_signing() -> list[Frame]:
    """The first 29 s: one key, no restart (which makes a vehicle repeat its last stamps)."""
    framer, records = Framer(), list(read_tlog(DATA / "07_signing_port_b.tlog"))
    first_us = records[0][0]
    return [f for us, raw in records for f in framer.feed(raw) if us < first_us + 29_000_000]


def test_signatures_of_a_real_autopilot_are_verified(recorded_signing):
    """Each signed frame of ArduCopter is good once and a replay the second time."""
    signer = make_signer(lambda: 0.0)
    ours = [f for f in recorded_signing if f.signed and f.system == 1]
    assert len(ours) > 20
    assert all(signer.accepts(frame) for frame in ours)
    assert signer.counters.good == len(ours)
    assert not any(signer.accepts(frame) for frame in ours)
    assert signer.counters.replayed == len(ours)


def test_the_station_frames_the_autopilot_refused_are_refused(recorded_signing):
    """Unsigned, wrong key and an hour old: all ignored by the vehicle, and by us."""
    signer = make_signer(lambda: 0.0)
    for frame in recorded_signing:
        signer.accepts(frame)
    counters = signer.counters
    assert counters.unsigned > 0
    assert counters.wrong > 0
    assert counters.replayed > 0
    assert counters.refused == counters.unsigned + counters.wrong + counters.replayed


def test_radios_may_stay_unsigned():
    """RADIO_STATUS passes without a signature, a heartbeat does not."""
    signer, codec, framer = make_signer(), mavlink.MAVLink(None, 51, 68), Framer()
    radio = mavlink.MAVLink_radio_status_message(1, 2, 3, 4, 5, 6, 7).pack(codec)
    beat = mavlink.MAVLink_heartbeat_message(2, 3, 81, 0, 3, 3).pack(codec)
    radio_frame, beat_frame = framer.feed(radio + beat)
    assert signer.accepts(radio_frame)
    assert not signer.accepts(beat_frame)


def test_a_forged_stamp_does_not_block_the_real_sender():
    """The stamp of a frame counts only when its signature is right."""
    sender, receiver = make_signer(), make_signer()
    forged = bytearray(signed(sender, stamp=ticks(NOW_S) + 999 * TICKS_PER_S))
    forged[-1] ^= 1
    (bad,) = Framer().feed(bytes(forged))
    (good,) = Framer().feed(signed(sender))
    assert not receiver.accepts(bad)
    assert receiver.accepts(good)


def test_a_new_stream_may_lag_a_minute_and_no_more():
    """Older first frames are taken for a recording of an earlier flight."""
    sender, receiver = make_signer(), make_signer()
    receiver.next_stamp()
    late = ticks(NOW_S)
    (old,) = Framer().feed(signed(sender, link=1, stamp=late - 61 * TICKS_PER_S))
    (fresh,) = Framer().feed(signed(sender, link=2, stamp=late - 59 * TICKS_PER_S))
    assert not receiver.accepts(old)
    assert receiver.accepts(fresh)


def test_stamps_rise_even_if_the_clock_goes_back_and_after_a_restart():
    """What was reserved on disk is never used again."""
    saved: list[int] = []
    times = iter([NOW_S, NOW_S - 3600.0, NOW_S - 3600.0])
    signer = make_signer(lambda: next(times), persist=saved.append)
    stamps = [signer.next_stamp() for _ in range(3)]
    assert stamps == sorted(set(stamps))
    again = make_signer(lambda: NOW_S - 3600.0, floor=saved[-1])
    assert again.next_stamp() > max(stamps)


def test_the_key_is_not_in_any_text():
    """A signer may be printed or logged."""
    text = repr(make_signer())
    assert KEY.hex() not in text
    assert str(KEY) not in text


def test_keys_have_32_bytes():
    """Anything else is a programming error."""
    with pytest.raises(ValueError, match="32"):
        Signer(b"short", lambda: 0.0)


def test_station_defaults_to_a_component_of_its_own():
    """Uploads are locked per system and component: 255/0 and 255/190 are other programs'."""
    assert (Station().system, Station().component) == (255, 191)


def test_a_key_file_is_private_and_gives_its_key_back(tmp_path):
    """Mode 0600, 32 random bytes, never the same twice."""
    first, second = tmp_path / "a.key", tmp_path / "b.key"
    create_key(first)
    create_key(second)
    assert first.stat().st_mode & 0o777 == 0o600
    assert len(read_key(first)) == 32
    assert read_key(first) != read_key(second)


def test_a_passphrase_gives_the_key_that_other_stations_make_of_it(tmp_path):
    """SHA-256 of the text, as Mission Planner and MAVProxy do."""
    create_key(tmp_path / "k", "test key one")
    assert read_key(tmp_path / "k") == hashlib.sha256(b"test key one").digest()


def test_a_key_that_others_may_read_is_refused(tmp_path):
    """The message says what to run."""
    path = tmp_path / "k"
    create_key(path)
    path.chmod(0o640)
    with pytest.raises(SigningError, match="chmod 600"):
        read_key(path)


def test_an_existing_key_is_not_overwritten(tmp_path):
    """A key may be the only copy."""
    create_key(tmp_path / "k")
    with pytest.raises(SigningError, match="cannot be created"):
        create_key(tmp_path / "k")


@pytest.mark.parametrize("text", ["", "12ab", "00" * 32, "zz" * 32, "é"])
def test_a_bad_key_is_refused_without_showing_it(tmp_path, text):
    """Not even a wrong key stands in a message."""
    path = tmp_path / "k"
    path.write_text(text, encoding="utf-8")
    path.chmod(0o600)
    with pytest.raises(SigningError) as caught:
        read_key(path)
    assert not text or text not in str(caught.value)


def test_the_stamp_survives(tmp_path):
    """Saved stamps are read back; none is 0; nonsense is an error."""
    stamps = StampFile(tmp_path / "k")
    assert stamps.load() == 0
    stamps.save(123)
    stamps.save(456)
    assert StampFile(tmp_path / "k").load() == 456
    stamps.path.write_text("nonsense")
    with pytest.raises(SigningError, match="cannot be read"):
        stamps.load()
