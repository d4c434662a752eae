"""What ArduCopter keeps of an item, how two missions differ in it, and a hash over it.

ArduCopter 4.5.5 rounds, drops and renames parts of what it is sent without saying so (measured).
Two missions are the same when their stored forms are.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.protocol.item import FENCE, MISSION, RALLY, TYPE_NAMES, Item, Mission, float32

# Per command, what becomes of param1 … param4:
# k kept, i cut to a whole number, s only its sign (0 counts as +), 0 dropped.
_KEPT = {
    mavlink.MAV_CMD_NAV_WAYPOINT: "i000",
    mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT: "i000",
    mavlink.MAV_CMD_NAV_LOITER_UNLIM: "00i0",
    mavlink.MAV_CMD_NAV_LOITER_TURNS: "k0ik",
    mavlink.MAV_CMD_NAV_LOITER_TIME: "i0s0",
    mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: "0000",
    mavlink.MAV_CMD_NAV_LAND: "i00s",
    mavlink.MAV_CMD_NAV_TAKEOFF: "i000",
    mavlink.MAV_CMD_CONDITION_DELAY: "k000",
    mavlink.MAV_CMD_CONDITION_DISTANCE: "k000",
    mavlink.MAV_CMD_DO_JUMP: "ii00",
    mavlink.MAV_CMD_DO_CHANGE_SPEED: "kkk0",
    mavlink.MAV_CMD_DO_DIGICAM_CONTROL: "iiii",
    mavlink.MAV_CMD_DO_MOUNT_CONTROL: "kkk0",
}
_FRAMES = {
    mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT: mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT,
    mavlink.MAV_FRAME_GLOBAL_INT: mavlink.MAV_FRAME_GLOBAL,
    mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT_INT: mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT,
    mavlink.MAV_FRAME_MISSION: mavlink.MAV_FRAME_GLOBAL,
}
# Heights are kept in centimetres, cut from a 32-bit product: one may be lost.
HEIGHT_TOLERANCE_CM = 1


@dataclass(frozen=True)
class Stored:
    """The stored form of one item."""

    command: int
    frame: int
    params: tuple[float, ...]
    x: int
    y: int
    height_cm: int

    def matches(self, other: Stored) -> bool:
        """Whether two stored forms are the same item."""
        return (
            self.command == other.command
            and self.frame == other.frame
            and self.params == other.params
            and (self.x, self.y) == (other.x, other.y)
            and abs(self.height_cm - other.height_cm) <= HEIGHT_TOLERANCE_CM
        )

    def __str__(self) -> str:
        params = " ".join(f"{p:g}" for p in self.params)
        return (
            f"command {self.command} frame {self.frame} params {params} "
            f"x {self.x} y {self.y} height {self.height_cm / 100:.2f} m"
        )


def stored(item: Item, mission_type: int = MISSION) -> Stored:
    """The form in which the autopilot keeps an item; the same for what it reads back."""
    if mission_type == FENCE:
        return Stored(item.command, 0, item.params, item.x, item.y, 0)
    frame = _FRAMES.get(item.frame, item.frame)
    if mission_type == RALLY:
        return Stored(item.command, frame, (), item.x, item.y, int(item.z) * 100)
    params = tuple(
        _keep(rule, value)
        for rule, value in zip(_KEPT.get(item.command, "kkkk"), item.params, strict=True)
    )
    if item.command == mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH:
        return Stored(item.command, 0, params, 0, 0, 0)
    if not item.has_position:
        return Stored(item.command, 0, params, item.x, item.y, 0)
    return Stored(item.command, frame, params, item.x, item.y, round(item.z * 100))


def _keep(rule: str, value: float) -> float:
    if rule == "0" or math.isnan(value):
        return 0.0
    if rule == "i":
        return float(int(value))
    if rule == "s":
        return math.copysign(1.0, value) if value else 1.0
    return float32(value)


def differences(
    sent: Sequence[Item], held: Sequence[Item], mission_type: int = MISSION
) -> tuple[str, ...]:
    """Every difference between a mission sent and one read back, in words; empty if none.

    Item 0 of a mission is the autopilot's home and not compared.
    """
    first = 1 if mission_type == MISSION else 0
    found = []
    if len(sent) != len(held) and not (max(len(sent), len(held)) <= first):
        found.append(f"{len(sent)} items sent, {len(held)} on board")
    for seq, (a, b) in enumerate(zip(sent, held, strict=False)):
        ours, theirs = stored(a, mission_type), stored(b, mission_type)
        if seq >= first and not ours.matches(theirs):
            found.append(f"item {seq}: sent {ours}, on board {theirs}")
    return tuple(found)


def mission_hash(mission: Mission) -> str:
    """SHA-256 (64 hexadecimal digits) over the stored form of items, fence and rally points.

    Home, `current` and `autocontinue` do not count: the autopilot sets them itself.
    """
    digest = hashlib.sha256()
    for mission_type in (MISSION, FENCE, RALLY):
        first = 1 if mission_type == MISSION else 0
        for seq, item in enumerate(mission.of_type(mission_type)):
            if seq < first:
                continue
            form = stored(item, mission_type)
            params = " ".join(repr(p) for p in form.params)
            line = (
                f"{mission_type} {seq} {form.command} {form.frame} {params} "
                f"{form.x} {form.y} {form.height_cm}\n"
            )
            digest.update(line.encode("ascii"))
    return digest.hexdigest()


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
