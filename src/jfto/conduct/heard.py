"""Diagnostics of the graph's nodes, turned into what the conductor sees."""

from __future__ import annotations

from collections.abc import Sequence

from jfto.conduct.seen import Seen, UavSeen
from jfto_msgs_py.ros.diagnostics import ERROR, OK, Diagnostics, Status

_BRIDGE, _PLANNER = "mavlink_bridge", "planner_node"


class Heard:
    """Keeps the last diagnostics of each node."""

    def __init__(self, uavs: Sequence[str]) -> None:
        self._uavs = tuple(uavs)
        self._nodes: dict[str, dict[str, Status]] = {}

    def take(self, diagnostics: Diagnostics) -> None:
        """A node has said how it is."""
        self._nodes[diagnostics.node_name] = {each.uav_id: each for each in diagnostics.statuses}

    def forget(self, node_name: str) -> None:
        """A node is gone: what it said no longer holds."""
        self._nodes.pop(node_name, None)

    def seen(self, now_s: float, fleet_s: float) -> Seen:
        """The fleet as it was last heard of."""
        bridge = self._nodes.get(_BRIDGE, {})
        planner = self._nodes.get(_PLANNER, {}).get("")
        link = bridge.get("")
        note = "the bridge has not reported yet"
        if link is not None:
            note = "" if link.level == OK else link.text
        if planner is not None and planner.level == ERROR:
            note = note or f"the planner has no plan: {planner.text}"
        planned = planner is not None and planner.level == OK
        uavs = {uav: _vehicle(bridge.get(uav)) for uav in self._uavs} if link is not None else {}
        return Seen(now_s, fleet_s, note, planned, uavs)


def _vehicle(status: Status | None) -> UavSeen:
    if status is None or "armed" not in status.facts:
        return UavSeen()
    facts = status.facts
    silent_s = _number(facts.get("silent_s", ""))
    return UavSeen(
        heard=facts.get("link") == "up",
        silent_s=float("inf") if silent_s is None else silent_s,
        armed=facts["armed"] == "true",
        mode=facts.get("mode", ""),
        reached=int(_number(facts.get("waypoints_reached", "")) or 0),
    )


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None
