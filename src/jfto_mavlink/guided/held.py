"""What a guided flight must know after a restart: the curve of each UAV, and how far it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.files import FileKind, read_record, write_record
from jfto_msgs_py.records.vehicle import TimedTrajectory

Point = tuple[float, float, float]
_CURE = "It is written anew."
_CURVES = FileKind("curves", _CURE, format="jfto-curves", version=1, size_limit=200_000_000)
_STATE = FileKind("guided flight", _CURE, format="jfto-guided-flight", version=1)


@dataclass(frozen=True)
class _Curve:
    """A trajectory in plain numbers; `offset_ns` counts from the beginning."""

    offset_ns: tuple[int, ...]
    position_m: tuple[Point, ...]
    velocity_mps: tuple[Point, ...]
    acceleration_mps2: tuple[Point, ...]


@dataclass(frozen=True)
class _Curves:
    """The curves of a fleet, by UAV."""

    uavs: Mapping[str, _Curve]


@dataclass(frozen=True)
class GuidedState:
    """A guided flight under way. Times are ns since the epoch on the graph's clock.

    At `at_ns` the fleet was `elapsed_s` along its curves, which began at `zero_ns`. `paused` says
    that an operator holds it. `over` is True once nobody is streamed to any more.
    """

    zero_ns: int
    at_ns: int
    elapsed_s: float
    paused: bool = False
    over: bool = False


class HeldFlight:
    """Keeps both beside `path`, the file of the flight's state; None: nowhere."""

    def __init__(self, path: Path | None) -> None:
        self._curves = None if path is None else path.with_name("guided_curves.json")
        self._state = None if path is None else path.with_name("guided_flight.json")

    def keep_curves(self, curves: Mapping[str, TimedTrajectory]) -> None:
        """Write the curves; raises InputError."""
        if self._curves is not None:
            plain = {uav: _plain(curve) for uav, curve in curves.items()}
            write_record(_Curves(plain), self._curves, _CURVES)

    def keep(self, state: GuidedState) -> None:
        """Write how far the flight is; raises InputError."""
        if self._state is not None:
            write_record(state, self._state, _STATE)

    def state(self) -> GuidedState | None:
        """The flight under way, None where there is none. Raises InputError for another file."""
        if self._state is None or not self._state.exists():
            return None
        state = read_record(self._state, GuidedState, _STATE)
        return None if state.over else state

    def curves(self) -> dict[str, TimedTrajectory]:
        """The curves kept, with time zero at 0. Raises InputError, MessageError."""
        if self._curves is None:
            raise InputError("no state_file is given, so no curves were kept.")
        found = read_record(self._curves, _Curves, _CURVES)
        return {
            uav: TimedTrajectory(
                0,
                np.array(one.offset_ns, dtype=np.int64),
                np.array(one.position_m),
                np.array(one.velocity_mps),
                np.array(one.acceleration_mps2),
            )
            for uav, one in found.uavs.items()
        }


def _plain(curve: TimedTrajectory) -> _Curve:
    return _Curve(
        tuple(curve.offset_ns.tolist()),
        tuple(map(tuple, curve.position_m.tolist())),
        tuple(map(tuple, curve.velocity_mps.tolist())),
        tuple(map(tuple, curve.acceleration_mps2.tolist())),
    )
