"""Which recorded answers the simulator gives too: type, codes, key fields, order, time."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Hashable
from dataclasses import dataclass, field

from jfto_sim.dialect import Message
from support.conformance.replay import Answer

# groups within which order must be the same
_PROTOCOL = frozenset(
    {"MISSION_REQUEST", "MISSION_REQUEST_INT", "MISSION_ACK", "MISSION_COUNT", "MISSION_ITEM_INT",
     "MISSION_ITEM", "COMMAND_ACK", "MESSAGE_INTERVAL"}
)  # fmt: skip
ANSWERS = _PROTOCOL | {
    "STATUSTEXT", "PARAM_VALUE", "AUTOPILOT_VERSION", "HOME_POSITION", "GPS_GLOBAL_ORIGIN",
    "MISSION_ITEM_REACHED", "CAMERA_FEEDBACK",
}  # fmt: skip
_KEYS: dict[str, tuple[str, ...]] = {
    "HEARTBEAT": ("custom_mode", "base_mode", "system_status"),
    "COMMAND_ACK": ("command", "result", "target_system", "target_component"),
    "MISSION_REQUEST": ("target_system", "target_component", "seq", "mission_type"),
    "MISSION_ACK": ("target_system", "target_component", "type", "mission_type"),
    "MISSION_COUNT": ("target_system", "target_component", "count", "mission_type"),
    "MISSION_ITEM_REACHED": ("seq",),
    "MISSION_CURRENT": ("seq", "total", "mission_state", "mission_mode"),
    "MESSAGE_INTERVAL": ("message_id", "interval_us"),
    "AUTOPILOT_VERSION": ("capabilities", "flight_sw_version"),
    "EXTENDED_SYS_STATE": ("landed_state",),
    "GPS_RAW_INT": ("fix_type",),
    "GPS_GLOBAL_ORIGIN": ("latitude", "longitude", "altitude"),
    "FENCE_STATUS": ("breach_status",),
    "TERRAIN_REQUEST": ("grid_spacing", "mask"),
}
_ITEM = ("target_system", "target_component", "seq", "frame", "command", "autocontinue",
         "param1", "param2", "param3", "param4", "mission_type")  # fmt: skip
# parameters whose value is a measurement of that one power-up
_MEASURED = re.compile(r"^(BARO\d_GND|INS_|STAT_|MOT_THST_HOVER|COMPASS_)")
_NUMBER = re.compile(r"(Hit ground at|used) [\d.]+")
_EVENT_TYPES = ("STATUSTEXT", "MISSION_ITEM_REACHED", "MISSION_CURRENT", "EXTENDED_SYS_STATE")
# a station that was busy on another port read some parameter values 3 s late
_SLACK_S = {"HEARTBEAT": 1.3, "PARAM_VALUE": 3.0, "TIMESYNC": 1.5}
# written by a loop that runs once a second, 30 or 31 s after the last time
_STATISTICS_SLACK_S = 3.0
# the autopilot's own loop may swap what leaves at nearly the same time
_SWAP_S = 0.05
_EVENT_SLACK_S, _ANSWER_SLACK_S, _TELEMETRY_SLACK_S = 2.5, 0.25, 1.3


def key(message: Message) -> Hashable:
    """What must be the same in two answers that match."""
    kind = message.get_type()
    if kind == "STATUSTEXT":
        return kind, message.severity, _NUMBER.sub(r"\1 #", message.text)
    if kind == "PARAM_VALUE":
        value = "" if _MEASURED.match(message.param_id) else round(message.param_value, 3)
        return kind, message.param_id, value, message.param_type, message.param_index
    if kind in ("MISSION_ITEM_INT", "MISSION_ITEM"):
        return (kind, *(getattr(message, name) for name in _ITEM))
    return (kind, *(getattr(message, name) for name in _KEYS.get(kind, ())))


def _same_place(a: Message, b: Message) -> bool:
    """Positions of two items within 3 units of 1e-7 degree (or float resolution) and 0.1 m."""
    if a.get_type() not in ("MISSION_ITEM_INT", "MISSION_ITEM"):
        return True
    least = 3 if a.get_type() == "MISSION_ITEM_INT" else 1e-5
    near = abs(a.x - b.x) <= least and abs(a.y - b.y) <= least
    return near and abs(a.z - b.z) <= 0.1


def _group(message: Message) -> str:
    kind = message.get_type()
    station = getattr(message, "target_system", 0)
    return f"protocol {station}" if kind in _PROTOCOL else str(kind)


def _slack_s(message: Message) -> float:
    kind = message.get_type()
    if kind == "PARAM_VALUE" and message.param_id.startswith("STAT_"):
        return _STATISTICS_SLACK_S
    if kind in _SLACK_S:
        return _SLACK_S[kind]
    if kind in _EVENT_TYPES:
        return _EVENT_SLACK_S
    return _ANSWER_SLACK_S if kind in ANSWERS else _TELEMETRY_SLACK_S


@dataclass
class Score:
    """How many recorded frames the simulator matched; `missed` and `extra` for a closer look."""

    name: str
    answers: int = 0
    answers_matched: int = 0
    telemetry: int = 0
    telemetry_matched: int = 0
    missed: list[Answer] = field(default_factory=list)
    extra: list[Answer] = field(default_factory=list)
    errors_s: list[float] = field(default_factory=list)

    @property
    def share(self) -> float:
        """Matched share of the answers, 0..1."""
        return self.answers_matched / self.answers if self.answers else 1.0

    @property
    def telemetry_share(self) -> float:
        """Matched share of heartbeats and telemetry, 0..1."""
        return self.telemetry_matched / self.telemetry if self.telemetry else 1.0


def compare(name: str, recorded: list[Answer], simulated: list[Answer]) -> Score:
    """Match recorded answers to simulated ones, in order within each group."""
    score = Score(name)
    theirs: dict[Hashable, list[Answer]] = defaultdict(list)
    ours: dict[Hashable, list[Answer]] = defaultdict(list)
    shared = not any(a.port for a in recorded)
    for side, answers in ((theirs, recorded), (ours, simulated)):
        for a in answers:
            port = 0 if shared else a.port
            side[(a.system, port, a.epoch, _group(a.message))].append(a)
    for slot, wanted in theirs.items():
        _match(score, wanted, ours.get(slot, []))
    for slot, had in ours.items():
        if slot not in theirs:
            score.extra += had
    return score


def _match(score: Score, wanted: list[Answer], had: list[Answer]) -> None:
    keys = [key(a.message) for a in had]
    used = [False] * len(had)
    ordered = wanted[0].message.get_type() in _PROTOCOL
    at = 0
    for a in wanted:
        slack_s, sought = _slack_s(a.message), key(a.message)
        answer = a.message.get_type() in ANSWERS
        while at < len(had) and had[at].time_s < a.time_s - slack_s:
            at += 1
        found = None
        for k in range(at, len(had)):
            if had[k].time_s > a.time_s + slack_s:
                break
            if not used[k] and keys[k] == sought and _same_place(a.message, had[k].message):
                found = k
                break
        if answer:
            score.answers += 1
        else:
            score.telemetry += 1
        if found is None:
            score.missed.append(a)
            continue
        used[found] = True
        while ordered and at < found and had[at].time_s < had[found].time_s - _SWAP_S:
            at += 1
        score.errors_s.append(had[found].time_s - a.time_s)
        if answer:
            score.answers_matched += 1
        else:
            score.telemetry_matched += 1
    score.extra += [a for a, taken in zip(had, used, strict=True) if not taken]
