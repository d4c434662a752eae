"""What changed from one mission to another."""

from __future__ import annotations

from difflib import SequenceMatcher

from jfto_mavlink.mission.item import FENCE, MISSION, RALLY, TYPE_NAMES, Mission
from jfto_mavlink.mission.stored import stored


def diff_missions(old: Mission, new: Mission) -> tuple[str, ...]:
    """Changes from `old` to `new` in words, item by item as the autopilot would store them.

    Lines begin with "-" (only in old) or "+" (only in new). Empty if both would fly the same.
    """
    lines: list[str] = []
    for mission_type in (MISSION, FENCE, RALLY):
        first = 1 if mission_type == MISSION else 0
        before = [stored(item, mission_type) for item in old.of_type(mission_type)[first:]]
        after = [stored(item, mission_type) for item in new.of_type(mission_type)[first:]]
        name = TYPE_NAMES[mission_type]
        matcher = SequenceMatcher(a=before, b=after, autojunk=False)
        for tag, a0, a1, b0, b1 in matcher.get_opcodes():
            if tag == "equal":
                continue
            lines += [f"- {name} {first + k}: {before[k]}" for k in range(a0, a1)]
            lines += [f"+ {name} {first + k}: {after[k]}" for k in range(b0, b1)]
    lines += [
        f"- {name} {value:g}"
        for name, value in old.parameters
        if (name, value) not in new.parameters
    ]
    lines += [
        f"+ {name} {value:g}"
        for name, value in new.parameters
        if (name, value) not in old.parameters
    ]
    return tuple(lines)
