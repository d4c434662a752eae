"""Telemetry logs."""

from __future__ import annotations

from pymavlink import mavutil

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.files.tlog import TlogWriter, read_tlog


def beats(count: int) -> list[bytes]:
    codec = mavlink.MAVLink(None, 1, 1)
    raw = []
    for _ in range(count):
        raw.append(mavlink.MAVLink_heartbeat_message(2, 3, 81, 0, 3, 3).pack(codec))
        codec.seq = (codec.seq + 1) % 256
    return raw


def test_other_tools_read_the_log(tmp_path):
    """Pymavlink's own log reader, which MAVExplorer is built on, sees every message and time."""
    path = tmp_path / "deep" / "uav1.tlog"
    writer = TlogWriter(path)
    for n, raw in enumerate(beats(5)):
        writer.write(1_700_000_000_000_000 + n * 100_000, raw)
    writer.close()
    log = mavutil.mavlink_connection(str(path))
    stamps = []
    while (message := log.recv_match(type="HEARTBEAT")) is not None:
        stamps.append(message._timestamp)
    log.close()
    assert len(stamps) == 5
    assert abs(stamps[1] - stamps[0] - 0.1) < 1e-5


def test_a_record_cut_short_by_a_crash_is_dropped_when_writing_goes_on(tmp_path):
    """Whatever the last write left, what follows is readable."""
    first, second, third = beats(3)
    path = tmp_path / "a.tlog"
    writer = TlogWriter(path)
    writer.write(1, first)
    writer.write(2, second)
    writer.close()
    whole = path.read_bytes()
    for cut in range(len(whole) // 2 + 1, len(whole)):
        path.write_bytes(whole[:cut])
        again = TlogWriter(path)
        again.write(3, third)
        again.close()
        assert list(read_tlog(path)) == [(1, first), (3, third)]
