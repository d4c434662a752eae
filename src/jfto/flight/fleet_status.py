"""What the conductor goes by: how the fleet is, from the diagnostics of the graph's nodes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from jfto_msgs_py.ros.diagnostics import ERROR, OK, Diagnostics, Status


@dataclass(frozen=True)
class VehicleStatus:
    """One vehicle: whether its link is up, how long it has been silent (s of its clock), …

    … whether it is armed, in which mode, how many of its waypoints it has reached, how late the
    last of them, where that is known, whether a trajectory is streamed to it, and why it cannot be
    spoken with, "" if it can.
    """

    linked: bool = False
    silent_s: float = float("inf")
    armed: bool = False
    mode: str = ""
    reached: int = 0
    late_s: float | None = None
    streamed: bool = False
    trouble: str = ""

    @property
    def down(self) -> bool:
        """Whether it is known to be disarmed."""
        return self.linked and not self.armed

    @property
    def on_plan(self) -> bool:
        """Whether it flies what was planned: its mission, or a trajectory."""
        return self.armed and (self.mode == "AUTO" or self.streamed)


@dataclass(frozen=True)
class FleetStatus:
    """The fleet at `now_s` of this computer's clock and `fleet_s` of the vehicles'.

    `note` says why the bridge is not linked, "" if it is. `planned` says that the planner has
    published the plan.
    """

    now_s: float
    fleet_s: float
    note: str
    planned: bool
    uavs: Mapping[str, VehicleStatus] = field(default_factory=dict)

    @property
    def all_linked(self) -> bool:
        """Whether every vehicle's link is up."""
        return not self.note and bool(self.uavs) and all(u.linked for u in self.uavs.values())

    @property
    def all_down(self) -> bool:
        """Whether every vehicle is known to be disarmed."""
        return not self.note and bool(self.uavs) and all(u.down for u in self.uavs.values())

    @property
    def awaited(self) -> str:
        """What the flight cannot begin without, in words."""
        if self.note:
            return self.note
        silent = [name for name, uav in self.uavs.items() if not uav.linked]
        return f"{', '.join(silent)} not heard" if silent else "no plan came"


_BRIDGE, _PLANNER = "mavlink_bridge", "planner_node"


class GraphStatus:
    """Keeps the last diagnostics of each node."""

    def __init__(self, uavs: Sequence[str]) -> None:
        self._uavs = tuple(uavs)
        self._nodes: dict[str, dict[str, Status]] = {}
        # The vehicles' time when the bridge that is there was heard of first.
        self._bridge_from_s: float | None = None

    def take(self, diagnostics: Diagnostics) -> None:
        """A node has said how it is."""
        self._nodes[diagnostics.node_name] = {each.uav_id: each for each in diagnostics.statuses}

    def forget(self, node_name: str) -> None:
        """A node is gone: what it said no longer holds."""
        self._nodes.pop(node_name, None)

    def fleet(self, now_s: float, fleet_s: float) -> FleetStatus:
        """The fleet by the last diagnostics."""
        bridge = self._nodes.get(_BRIDGE, {})
        planner = self._nodes.get(_PLANNER, {}).get("")
        link = bridge.get("")
        note = "the bridge has not reported yet"
        if link is not None:
            note = "" if link.level == OK else link.text
        if planner is not None and planner.level == ERROR:
            note = note or f"the planner has no plan: {planner.text}"
        planned = planner is not None and planner.level == OK
        if link is None:
            self._bridge_from_s = None
            return FleetStatus(now_s, fleet_s, note, planned, {})
        if self._bridge_from_s is None:
            self._bridge_from_s = fleet_s
        # A bridge that was started in mid-flight has heard nobody yet, which is no silence.
        listened_s = fleet_s - self._bridge_from_s
        uavs = {uav: _vehicle(bridge.get(uav), listened_s) for uav in self._uavs}
        return FleetStatus(now_s, fleet_s, note, planned, uavs)


def _vehicle(status: Status | None, listened_s: float) -> VehicleStatus:
    if status is None or "armed" not in status.facts:
        return VehicleStatus(silent_s=listened_s)
    facts = status.facts
    silent_s = _number(facts.get("silent_s", ""))
    return VehicleStatus(
        linked=facts.get("link") == "up",
        silent_s=listened_s if silent_s is None or math.isinf(silent_s) else silent_s,
        armed=facts["armed"] == "true",
        mode=facts.get("mode", ""),
        reached=int(_number(facts.get("waypoints_reached", "")) or 0),
        late_s=_number(facts.get("late_s", "")),
        streamed=facts.get("stream") == "streaming",
        trouble=facts.get("trouble", ""),
    )


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None
