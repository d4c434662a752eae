"""Opening the vehicles of a roster."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, ExitStack
from dataclasses import dataclass
from pathlib import Path

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.fleet.changes import Event
from jfto_mavlink.fleet.link import FleetLink
from jfto_mavlink.fleet.roster import Roster
from jfto_mavlink.io.signing import Signer, StampFile, read_key
from jfto_mavlink.options import BridgeOptions
from jfto_mavlink.protocol.setup import DEFAULT_RATES
from jfto_mavlink.protocol.timesync import Clock, PacedClock
from jfto_msgs_py.plan import Plan


@dataclass(frozen=True)
class FleetRequest:
    """What is to be opened. `pads` holds latitude, longitude and height of each UAV's pad.

    `clock` is what their silences are counted on, None for the wall's; `unix` is UTC as they should
    have it.
    """

    plan: Plan
    pads: Mapping[str, tuple[float, float, float]]
    count: int
    speedup: float
    rates: Mapping[int, float]
    log_directory: Path | None
    on_event: Callable[[Event], None]
    clock: PacedClock | None = None
    unix: Clock = time.time


# Opens simulated vehicles on their pads, for as long as the context lasts.
OpenSimulated = Callable[[FleetRequest], AbstractContextManager[FleetLink]]


def rates(options: BridgeOptions) -> dict[int, float]:
    """Message rates, Hz: position and attitude as asked for, the fix at most as often.

    From vehicles whose time passes faster all but the position comes once a second of theirs.
    """
    wanted = options.telemetry_rate_hz
    if options.speedup > 1.0:
        return {
            **{message_id: min(rate, 1.0) for message_id, rate in DEFAULT_RATES.items()},
            mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: wanted,
        }
    return {
        **DEFAULT_RATES,
        mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: wanted,
        mavlink.MAVLINK_MSG_ID_ATTITUDE: wanted,
        mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: min(wanted, 5.0),
    }


def open_real(
    stack: ExitStack, options: BridgeOptions, roster: Roster, request: FleetRequest
) -> FleetLink:
    """Open the links of a roster's vehicles, heard or not; raises LinkError or SigningError."""
    signer = None
    if options.key_file:
        path = Path(options.key_file)
        stamps = StampFile(path)
        signer = Signer(read_key(path), time.time, stamps.load(), stamps.save)
    return stack.enter_context(
        FleetLink(
            roster,
            clock=request.clock,
            unix=request.unix,
            signer=signer,
            log_directory=request.log_directory,
            rates=request.rates,
            on_event=request.on_event,
        )
    )
