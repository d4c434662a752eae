"""What a bag tells of a flight, on the plan's time: seconds after lift-off."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.records.event import Event
from jfto_msgs_py.records.network import Adjacency, PowerSchedule
from jfto_msgs_py.types import Array

READ_BACK, SETPOINT, UNKNOWN = "read back from the radio", "setpoint", "not recorded"


@dataclass(frozen=True, eq=False)
class Track:
    """Measured places of one UAV: `times_s` (M,) grows, `position_m` (M, 3) is ENU metres."""

    times_s: Array
    position_m: Array

    def at(self, times_s: Array) -> Array:
        """Places (T, 3), straight between poses, held beyond them; nan where there are none."""
        if not self.times_s.size:
            return np.full((*np.shape(times_s), 3), np.nan)
        columns = [np.interp(times_s, self.times_s, axis) for axis in self.position_m.T]
        return np.stack(columns, axis=-1)


@dataclass(frozen=True, eq=False)
class PowerSteps:
    """Transmit power of one UAV: `power_w[k]` is in force from `times_s[k]` on, both (M,).

    `source` is READ_BACK, SETPOINT or UNKNOWN.
    """

    times_s: Array
    power_w: Array
    source: str

    def at(self, times_s: Array) -> Array:
        """Power in W at each time; 0 before the first is known."""
        if not self.times_s.size:
            return np.zeros(np.shape(times_s))
        return np.where(times_s >= self.times_s[0], self.power_w[_last(self, times_s)], 0.0)


@dataclass(frozen=True, eq=False)
class AirLog:
    """What the air itself reported: one quantity at `times_s` (M,), values (M, A) or (M, A, A)."""

    times_s: Array
    values: Array

    def at(self, times_s: Array) -> Array:
        """The last value reported by each time; before the first, that one."""
        return np.asarray(self.values[_last(self, times_s)])


def _last(log: PowerSteps | AirLog, times_s: Array) -> NDArray[np.intp]:
    """Index of the last entry at or before each time, 0 before the first."""
    return np.maximum(np.searchsorted(log.times_s, times_s, side="right") - 1, 0)


@dataclass(frozen=True)
class Trouble:
    """A spell during which a node said that something was amiss, in seconds after lift-off."""

    node: str
    uav: str
    level: int
    text: str
    from_s: float
    to_s: float


@dataclass(frozen=True, eq=False)
class RecordedFlight:
    """Everything that was read. UAVs are those of the plan, in its order.

    `lift_off_ns` is time zero and `lift_off_source` says where it is known from. `air` maps
    "power", "energy", "rate" and "delivery" to what the simulated air reported; it is empty for
    real vehicles. `complete` is False for a recording that was cut off. `notes` say what was
    missing or malformed.
    """

    uav_ids: tuple[str, ...]
    lift_off_ns: int
    lift_off_source: str
    tracks: Mapping[str, Track]
    powers: Mapping[str, PowerSteps]
    air: Mapping[str, AirLog] = field(default_factory=dict)
    adjacency: tuple[Adjacency, ...] = ()
    schedules: tuple[PowerSchedule, ...] = ()
    events: tuple[Event, ...] = ()
    troubles: tuple[Trouble, ...] = ()
    complete: bool = True
    notes: tuple[str, ...] = ()

    @property
    def last_s(self) -> float:
        """When the last pose of any UAV was taken, 0 without any."""
        ends = [float(track.times_s[-1]) for track in self.tracks.values() if track.times_s.size]
        return max(ends, default=0.0)

    def seconds(self, stamp_ns: int) -> float:
        """A time as seconds after lift-off."""
        return (stamp_ns - self.lift_off_ns) / 1e9
