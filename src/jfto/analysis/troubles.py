"""Spells of trouble in the nodes' diagnostics."""

from __future__ import annotations

from collections.abc import Sequence

from jfto.analysis.record import Trouble
from jfto_msgs_py.ros.diagnostics import OK, Diagnostics, Status

# Diagnostics come once a second; a longer silence ends a spell.
_APART_S = 3.0


def troubles_of(said: Sequence[Diagnostics], lift_off_ns: int) -> tuple[Trouble, ...]:
    """Spells during which a node's status on a UAV, or on itself, was worse than OK.

    One that changes its level begins anew; the text is the spell's first.
    """
    open_spells: dict[tuple[str, str], Trouble] = {}
    ended: list[Trouble] = []
    for diagnostics in sorted(said, key=lambda each: each.stamp_ns):
        now_s = (diagnostics.stamp_ns - lift_off_ns) / 1e9
        for status in diagnostics.statuses:
            key = (diagnostics.node_name, status.uav_id)
            spell = open_spells.get(key)
            if spell is not None and _goes_on(spell, status, now_s):
                open_spells[key] = _longer(spell, now_s)
                continue
            if spell is not None:
                ended.append(open_spells.pop(key))
            if status.level != OK:
                open_spells[key] = Trouble(*key, status.level, status.text, now_s, now_s)
    return tuple(sorted([*ended, *open_spells.values()], key=lambda each: each.from_s))


def _goes_on(spell: Trouble, status: Status, now_s: float) -> bool:
    return status.level == spell.level and now_s - spell.to_s <= _APART_S


def _longer(spell: Trouble, now_s: float) -> Trouble:
    return Trouble(spell.node, spell.uav, spell.level, spell.text, spell.from_s, now_s)
