"""The vehicle's stored lists: mission, fence, rally. They outlive a restart."""

from __future__ import annotations

from dataclasses import dataclass, field

from jfto_sim.mission.items import Item

MISSION, FENCE, RALLY = 0, 1, 2
MISSION_CAPACITY = 650
CAPACITY = {MISSION: MISSION_CAPACITY, FENCE: 83, RALLY: 19}
POLYGON_IN, POLYGON_OUT, CIRCLE_IN, CIRCLE_OUT, RETURN_POINT = 5001, 5002, 5003, 5004, 5000
RALLY_POINT = 5100
_CORNERS_MIN, _CORNERS_MAX = 3, 255


@dataclass
class Store:
    """Items by mission type; `changes` counts every change of the mission."""

    lists: dict[int, list[Item]] = field(
        default_factory=lambda: {MISSION: [], FENCE: [], RALLY: []}
    )
    changes: int = 0

    def count(self, kind: int) -> int:
        """How many items a list holds."""
        return len(self.lists[kind])

    @property
    def mission(self) -> list[Item]:
        """The mission, home included as item 0."""
        return self.lists[MISSION]

    def truncate(self, count: int) -> bool:
        """Shorten the mission; true if that changed it."""
        if count >= len(self.mission):
            return False
        del self.mission[count:]
        self.changes += 1
        return True

    def put(self, seq: int, item: Item) -> None:
        """Replace or append one mission item."""
        if seq < len(self.mission):
            self.mission[seq] = item
        else:
            self.mission.append(item)
        self.changes += 1

    def replace(self, kind: int, items: list[Item]) -> None:
        """Replace a whole fence or rally list."""
        self.lists[kind] = items


def fence_fault(items: list[Item]) -> str:
    """What keeps fence items from making whole figures, empty if they do."""
    left, kind, size = 0, 0, 0.0
    for item in items:
        if item.command in (POLYGON_IN, POLYGON_OUT):
            if left == 0:
                size = item.params[0]
                if not _CORNERS_MIN <= size <= _CORNERS_MAX:
                    return f"Invalid vertex count ({size:.0f})"
                left, kind = int(size), item.command
            elif item.command != kind or item.params[0] != size:
                return "Unexpected vertex"
            left -= 1
        elif left or item.command not in (CIRCLE_IN, CIRCLE_OUT, RETURN_POINT):
            return "Unexpected fence item"
    return "Incomplete polygon" if left else ""


def fence_size(items: list[Item]) -> int:
    """FENCE_TOTAL: the corners and circles, and two more for each polygon."""
    polygons = sum(1.0 / i.params[0] for i in items if i.command in (POLYGON_IN, POLYGON_OUT))
    return len(items) + 2 * round(polygons)
