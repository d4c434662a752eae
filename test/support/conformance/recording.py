"""A recording (.tlog, .tlog.xz) with each frame placed on the vehicle's own clock.

A tlog holds 8 bytes of big-endian Unix microseconds and a raw frame, again and again. Where the
vehicle ran faster than the wall clock, its clock is rebuilt from the frames that carry it, and
from the power-up texts, whose times are known from recordings in real time; a restart begins a new
epoch.
"""

from __future__ import annotations

import lzma
import struct
from bisect import bisect_right
from dataclasses import dataclass, field
from pathlib import Path

from jfto_msgs_py.errors import InputError
from jfto_sim.boot import TEXT_TIMES_S
from jfto_sim.dialect import Message, mavlink

_STATION_FROM = 200
_V2, _V1 = 0xFD, 0xFE
_RESTART_S, _LATE_TEXT_S = 8.0, 1.0
_KNOT_S = 0.02


@dataclass(frozen=True)
class Entry:
    """One recorded frame: wall time in seconds since 1970, its bytes, its decoded form."""

    wall_s: float
    raw: bytes
    message: Message

    @property
    def system(self) -> int:
        """Sender's system id."""
        return int(self.message.get_srcSystem())

    @property
    def from_station(self) -> bool:
        """Whether a station sent it."""
        return self.system >= _STATION_FROM


@dataclass
class Clock:
    """Wall time to (epoch, vehicle seconds) for one vehicle."""

    epochs: list[list[tuple[float, float]]] = field(default_factory=list)
    starts: list[float] = field(default_factory=list)

    def at(self, wall_s: float) -> tuple[int, float]:
        """Epoch and vehicle time of a wall time; straight lines between what is known."""
        epoch = max(0, bisect_right(self.starts, wall_s) - 1)
        knots = self.epochs[epoch]
        k = bisect_right(knots, (wall_s, float("inf")))
        low = min(max(k - 1, 0), max(len(knots) - 2, 0))
        (w0, v0), (w1, v1) = knots[low], knots[min(low + 1, len(knots) - 1)]
        slope = (v1 - v0) / (w1 - w0) if w1 > w0 else 1.0
        return epoch, v0 + slope * (wall_s - w0)


@dataclass(frozen=True)
class Recording:
    """All frames of one or more ports of the same vehicles; `port` of a frame is its file."""

    name: str
    entries: tuple[tuple[int, Entry], ...]
    clocks: dict[int, Clock]


def _frames(data: bytes) -> list[Entry]:
    codec = mavlink.MAVLink(None)
    codec.robust_parsing = True
    entries, at = [], 0
    while at + 10 < len(data):
        (stamp,) = struct.unpack(">Q", data[at : at + 8])
        at += 8
        if data[at] == _V2:
            size = 12 + data[at + 1] + (13 if data[at + 2] & 1 else 0)
        elif data[at] == _V1:
            size = 8 + data[at + 1]
        else:
            raise InputError(f"Byte {at} of the recording is {data[at]:#x}, no frame begins there.")
        raw = data[at : at + size]
        at += size
        entries.append(Entry(stamp * 1e-6, raw, codec.decode(bytearray(raw))))
    return entries


def _vehicle_time_s(message: Message) -> float | None:
    kind = message.get_type()
    if kind == "TIMESYNC":
        return float(message.ts1 * 1e-9) if message.tc1 == 0 else None
    if kind in ("GPS_GLOBAL_ORIGIN", "HOME_POSITION"):
        return float(message.time_usec * 1e-6)
    if kind == "STATUSTEXT":
        return TEXT_TIMES_S.get(message.text)
    stamp = getattr(message, "time_boot_ms", None)
    return None if stamp is None else float(stamp * 1e-3)


def _clock(entries: list[Entry], system: int) -> Clock:
    clock = Clock()
    last = -1.0
    speed_changes = []
    for entry in entries:
        m = entry.message
        if entry.from_station:
            if m.get_type() == "PARAM_SET" and m.param_id == "SIM_SPEEDUP":
                speed_changes.append((entry.wall_s, float(m.param_value)))
            continue
        if entry.system != system:
            continue
        now = _vehicle_time_s(m)
        if now is None:
            continue
        late = _LATE_TEXT_S if m.get_type() == "STATUSTEXT" else _RESTART_S
        if not clock.epochs or now < last - late:
            clock.epochs.append([])
            last = now
        knots = clock.epochs[-1]
        if now >= last and (not knots or entry.wall_s > knots[-1][0] + _KNOT_S):
            knots.append((entry.wall_s, now))
        last = max(last, now)
    if not clock.epochs:
        clock.epochs.append([(entries[0].wall_s, 0.0)])
    for epoch in clock.epochs:
        _bend(epoch, speed_changes)
    clock.starts = [_start(epoch, entries) for epoch in clock.epochs]
    return clock


def _bend(knots: list[tuple[float, float]], changes: list[tuple[float, float]]) -> None:
    """Add a knot where a change of speed-up to or from real time falls between two others."""
    before = 0.0
    for wall_s, factor in changes:
        k = bisect_right(knots, (wall_s, float("inf")))
        if 0 < k < len(knots):
            (w0, v0), (w1, v1) = knots[k - 1], knots[k]
            if factor == 1.0:
                knots.insert(k, (wall_s, v1 - (w1 - wall_s)))
            elif before == 1.0:
                knots.insert(k, (wall_s, v0 + (wall_s - w0)))
        before = factor


def _start(knots: list[tuple[float, float]], entries: list[Entry]) -> float:
    """Wall time at which an epoch's clock was zero, but not before the recording began."""
    (w0, v0), (w1, v1) = knots[0], knots[min(1, len(knots) - 1)]
    slope = (v1 - v0) / (w1 - w0) if w1 > w0 else 1.0
    return max(entries[0].wall_s - 60.0, w0 - v0 / max(slope, 0.1))


def read_recording(*paths: Path) -> Recording:
    """Read one file, or one per port of the same vehicles; raises InputError on a broken file."""
    numbered: list[tuple[int, Entry]] = []
    for port, path in enumerate(paths):
        data = path.read_bytes()
        if path.suffix == ".xz":
            data = lzma.decompress(data)
        numbered += [(port, entry) for entry in _frames(data)]
    if not numbered:
        raise InputError(f"{paths[0]} holds no frames.")
    numbered.sort(key=lambda pair: pair[1].wall_s)
    everything = [entry for _, entry in numbered]
    systems = sorted({e.system for e in everything if not e.from_station})
    clocks = {system: _clock(everything, system) for system in systems}
    return Recording(paths[0].name.split(".")[0], tuple(numbered), clocks)
