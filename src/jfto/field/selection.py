"""What is shown where there is not room for all: trouble first."""

from __future__ import annotations

from collections.abc import Sequence

from jfto.field.state import INFO, FieldEvent, FieldState, UavField
from jfto.field.words import troubles


def shown_uavs(state: FieldState, room: int) -> tuple[tuple[UavField, ...], tuple[UavField, ...]]:
    """At most `room` UAVs in the fleet's order, those with most amiss kept; and the others."""
    if len(state.uavs) <= room:
        return state.uavs, ()
    worst = sorted(state.uavs, key=lambda uav: -troubles(uav, state.k_min))[: max(room - 1, 1)]
    kept = {uav.id for uav in worst}
    return (
        tuple(uav for uav in state.uavs if uav.id in kept),
        tuple(uav for uav in state.uavs if uav.id not in kept),
    )


def shown_events(events: Sequence[FieldEvent], room: int) -> tuple[tuple[FieldEvent, ...], int]:
    """At most `room` events, oldest first, and how many are left out.

    The newest stays, then the last warning of each kind and UAV, newest first, then what is left,
    newest first.
    """
    last: dict[tuple[str, str], int] = {}
    for index, one in enumerate(events):
        if one.level != INFO:
            last[one.uav, one.kind] = index
    newest_first = range(len(events) - 1, -1, -1)
    pinned = sorted(last.values(), reverse=True)
    kept = sorted(list(dict.fromkeys([*newest_first[:1], *pinned, *newest_first]))[:room])
    return tuple(events[index] for index in kept), len(events) - len(kept)
