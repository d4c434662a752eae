"""Parameters that are set for a flight and put back after it, with a file that outlives both.

What a vehicle had before is on disk before the first of its parameters is changed, so that
whatever is killed, the next run or `jfto mission restore` can put it back.
"""

from __future__ import annotations

import threading
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from jfto_mavlink.errors import CommandError, FlightError
from jfto_mavlink.protocol.exchange import Context, Exchange, Report, wait_for
from jfto_mavlink.protocol.parameter import equal, read_parameters, set_parameter
from jfto_msgs_py.files import FileKind, read_record, write_record

DISARMED_WAIT_S = 3.0
_FILE = FileKind(
    "record of changed parameters",
    "It says what vehicles had before a flight: put them back by hand, then delete it.",
    format="jfto-changed-parameters",
    size_limit=1_000_000,
)


@dataclass(frozen=True)
class Before:
    """What a vehicle had: `uid` is its AUTOPILOT_VERSION's, "" if unknown; `values` by name."""

    uid: str
    values: Mapping[str, float]


@dataclass(frozen=True)
class _Record:
    vehicles: Mapping[str, Before] = field(default_factory=dict)


class ChangedParameters:
    """Which parameters of which vehicles are to be put back; kept in `path`, None: in memory only.

    Without any the file is not there. Raises InputError where the file does not hold a record.
    """

    def __init__(self, path: Path | None = None) -> None:
        self.path = path
        self._lock = threading.Lock()
        self._vehicles: dict[str, Before] = {}
        if path is not None and path.exists():
            self._vehicles = dict(read_record(path, _Record, _FILE).vehicles)

    @property
    def vehicles(self) -> Mapping[str, Before]:
        """What each UAV had before; empty where nothing is changed."""
        return dict(self._vehicles)

    def note(self, uav: str, uid: str, values: Mapping[str, float]) -> None:
        """Keep what a vehicle has; what is kept already is older, and stays."""
        with self._lock:
            known = self._vehicles.get(uav)
            older = known.values if known is not None and known.uid == uid else {}
            self._write({**self._vehicles, uav: Before(uid, {**values, **older})})

    def forget(self, uav: str) -> None:
        """A vehicle has everything back."""
        with self._lock:
            self._write({u: one for u, one in self._vehicles.items() if u != uav})

    def _write(self, vehicles: dict[str, Before]) -> None:
        self._vehicles = vehicles
        if self.path is None:
            return
        if vehicles:
            write_record(_Record(vehicles), self.path, _FILE)
        else:
            self.path.unlink(missing_ok=True)


def apply_parameters(
    context: Context, wanted: tuple[tuple[str, float], ...], changed: ChangedParameters
) -> Exchange[None]:
    """Set what a mission relies on, and keep what was there; raises CommandError, InputError."""
    held = yield from read_parameters(context, [name for name, _ in wanted])
    new = [(name, value) for name, value in wanted if not equal(held.get(name, value - 1), value)]
    old = {name: held[name] for name, _ in new if name in held}
    if old:
        changed.note(context.uav, context.vehicle.uid or "", old)
        told = ", ".join(f"{name} {held[name]:g} → {value:g}" for name, value in new)
        yield Report(f"sets {told}")
    for name, value in new:
        yield from set_parameter(context, name, value)


def compare_parameters(
    context: Context, wanted: tuple[tuple[str, float], ...]
) -> Exchange[tuple[str, ...]]:
    """How a vehicle's parameters are not those that a mission relies on, in words."""
    held = yield from read_parameters(context, [name for name, _ in wanted])
    return tuple(
        f"{name}: sent {value:g}, on board {f'{held[name]:g}' if name in held else 'unknown'}"
        for name, value in wanted
        if name not in held or not equal(held[name], value)
    )


def restore_parameters(context: Context, changed: ChangedParameters) -> Exchange[tuple[str, ...]]:
    """Put back what a vehicle had before, if anything; returns which parameters.

    Raises FlightError 601 in flight or for another airframe, CommandError 506 or 507.
    """
    before = changed.vehicles.get(context.uav)
    if before is None:
        return ()
    # The heartbeat after a start that was called off still says that it is armed.
    if not (yield from wait_for(context, lambda: not context.vehicle.armed, DISARMED_WAIT_S)):
        raise FlightError(601, f"{context.uav}: is armed; its parameters are put back after it.")
    uid = context.vehicle.uid or ""
    if before.uid and uid and uid != before.uid:
        raise FlightError(
            601, f"{context.uav}: is another vehicle (uid {uid}) than was changed ({before.uid})."
        )
    held = yield from read_parameters(context, before.values)
    put_back = {
        name: value
        for name, value in before.values.items()
        if name not in held or not equal(held[name], value)
    }
    if put_back and len(held) < len(before.values):
        lost = ", ".join(name for name in before.values if name not in held)
        raise CommandError(506, f"{context.uav}: no answer for {lost}; nothing was put back.")
    for name, value in put_back.items():
        yield from set_parameter(context, name, value)
    changed.forget(context.uav)
    told = ", ".join(f"{name} {value:g}" for name, value in put_back.items())
    yield Report(f"has {told or 'its parameters'} back")
    return tuple(put_back)
