"""What is shown where there is not room for all: trouble first."""

from __future__ import annotations

from collections.abc import Sequence

from jfto.flight.screen.state import FlightState, UavState
from jfto.flight.screen.texts import troubles
from jfto_msgs_py.records.event import WARN, Event


def shown_uavs(state: FlightState, room: int) -> tuple[tuple[UavState, ...], tuple[UavState, ...]]:
    """At most `room` UAVs in the fleet's order, those with most amiss kept; and the others."""
    if len(state.uavs) <= room:
        return state.uavs, ()
    worst = sorted(state.uavs, key=lambda uav: -troubles(uav, state.k_min))[: max(room - 1, 1)]
    kept = {uav.id for uav in worst}
    return (
        tuple(uav for uav in state.uavs if uav.id in kept),
        tuple(uav for uav in state.uavs if uav.id not in kept),
    )


def shown_events(events: Sequence[Event], room: int) -> tuple[tuple[Event, ...], int]:
    """At most `room` events, oldest first, and how many are left out.

    The newest stays, then the last warning of each kind and UAV, newest first, then what is left,
    newest first.
    """
    last: dict[tuple[str, str], int] = {}
    for index, one in enumerate(events):
        if one.level >= WARN:
            last[one.uav_id, one.kind] = index
    newest_first = range(len(events) - 1, -1, -1)
    pinned = sorted(last.values(), reverse=True)
    kept = sorted(list(dict.fromkeys([*newest_first[:1], *pinned, *newest_first]))[:room])
    return tuple(events[index] for index in kept), len(events) - len(kept)
