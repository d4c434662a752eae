"""Which waypoint of a route belongs to which item of its mission, both ways.

MISSION_ITEM_REACHED may carry the number of a DO item behind a waypoint instead of the waypoint's
own, so each of those numbers leads to the waypoint too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from jfto_mavlink.mission.item import Item


@dataclass(frozen=True)
class ItemMap:
    """`items[k]` is the item of the route's k-th waypoint; `count` the mission's item count."""

    items: tuple[int, ...]
    reached: tuple[int | None, ...]

    def waypoint(self, reached_seq: int) -> int | None:
        """Index along the route of the waypoint that a reached item stands for, if any."""
        return self.reached[reached_seq] if 0 <= reached_seq < len(self.reached) else None

    def next_waypoint(self, current_seq: int) -> int | None:
        """Index of the first waypoint not yet reached while item `current_seq` is flown."""
        for index, seq in enumerate(self.items):
            if seq >= current_seq:
                return index
        return None


def map_items(items: Sequence[Item], waypoint_items: Sequence[int]) -> ItemMap:
    """Map of a mission whose route waypoints are the given items."""
    index_of = {seq: index for index, seq in enumerate(waypoint_items)}
    reached: list[int | None] = []
    current: int | None = None
    for seq, item in enumerate(items):
        if item.is_nav:
            current = index_of.get(seq)
        reached.append(current)
    return ItemMap(tuple(waypoint_items), tuple(reached))
