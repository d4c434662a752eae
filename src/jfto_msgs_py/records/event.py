"""What happened in flight and what was done about it: one line for the operator.

The same record from whoever notices something, over the graph and a bag, to the report.
"""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.errors import MessageError

# Levels, as rcl_interfaces/Log has them.
DEBUG, INFO, WARN, ERROR, FATAL = 10, 20, 30, 40, 50


def grade(level: int) -> str:
    """What a level amounts to for a reader: "error", "warning" or "note"."""
    return "error" if level >= ERROR else "warning" if level >= WARN else "note"


# What an event may be about. Readers take others too: a node may be newer than they are.
KINDS = {
    "k_min": "a UAV has, or will have, fewer radio neighbours than asked for",
    "d_min": "two UAVs come, or will come, closer than allowed",
    "connectivity": "the fleet falls, or will fall, into parts",
    "energy": "a UAV's radio cannot pay for what is left of the mission",
    "late": "UAVs run late, or the slots were shifted",
    "stale": "no fresh pose of a UAV",
    "topology": "the topology is silent",
    "power": "powers could not be solved",
    "radio": "a radio failed to take its power",
    "vehicle": "a vehicle was lost, or came back",
    "gps": "a vehicle lost its position, or has it again",
    "battery": "a flight battery runs low",
    "link": "the link to a vehicle broke, or is back",
    "restart": "a node died and was started again",
    "order": "what was ordered, and what came of it",
    "guided": "trajectories streamed to vehicles: newer ones, or a stream that cannot go on",
    "pace": "how fast simulated vehicles' time passed, and for whom it waited",
    "lift_off": "the flight began",
    "mode": "a vehicle changed its flight mode, which nobody ordered here",
    "fence": "a vehicle left its fence",
    "failsafe": "another failsafe of a vehicle acted",
    "parameters": "parameters of vehicles were put back after a flight, or were not",
    "done": "a UAV has passed all its waypoints",
    "unvisited": "a UAV has left its mission, and waypoints with it",
    "landed": "a UAV, or the fleet, is down and disarmed",
}


@dataclass(frozen=True)
class Event:
    """One event: `level` is DEBUG … FATAL, `kind` one of KINDS, `text` one line.

    `uav_id` is "" where it is about no single UAV. `stamp_ns` (ns) is on the clock of `node`, who
    announced it: since the epoch in the graph; 0 and "" until somebody has. Raises MessageError
    where that does not hold, by the fields of rcl_interfaces/Log.
    """

    level: int
    kind: str
    uav_id: str
    text: str
    stamp_ns: int = 0
    node: str = ""

    def __post_init__(self) -> None:
        if self.level not in {DEBUG, INFO, WARN, ERROR, FATAL}:
            raise MessageError("level", f"is {self.level}, must be 10, 20, 30, 40 or 50")
        if not self.kind:
            raise MessageError("function", "is empty, must say the kind of event")
        if not self.text or "\n" in self.text:
            raise MessageError("msg", f"{self.text!r} is not one line")
