"""The reading half of the mission protocol, and what both halves share."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jfto_sim.dialect import WARNING, Message, mavlink
from jfto_sim.mission import items as kinds
from jfto_sim.mission.items import Item
from jfto_sim.mission.store import FENCE, MISSION, RALLY

if TYPE_CHECKING:
    from jfto_sim.vehicle import Vehicle


class MissionReading:
    """Answers a station that reads a list back; refuses while the list is being written."""

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle

    def busy(self, kind: int) -> bool:
        """Whether a list is being written."""
        raise NotImplementedError

    def _on_mission_request_list(self, m: Message, port: int) -> None:
        if not self._type_carried(m, port):
            return
        if self.busy(m.mission_type):
            self._ack(m, port, mavlink.MAV_MISSION_DENIED)
            return
        self._send_count(m, port)

    def _send_count(self, m: Message, port: int) -> None:
        count = mavlink.MAVLink_mission_count_message(
            m.get_srcSystem(),
            m.get_srcComponent(),
            self.vehicle.store.count(m.mission_type),
            m.mission_type,
        )
        self.vehicle.send(port, count)

    def _on_mission_request_int(self, m: Message, port: int) -> None:
        item = self._wanted(m, port)
        if item is None:
            return
        answer = mavlink.MAVLink_mission_item_int_message(
            m.get_srcSystem(), m.get_srcComponent(), m.seq, item.frame, item.command,
            0, 1 if m.mission_type == MISSION else 0, *item.params,
            item.x, item.y, item.z_m, m.mission_type,
        )  # fmt: skip
        self.vehicle.send(port, answer)

    def _on_mission_request(self, m: Message, port: int) -> None:
        item = self._wanted(m, port)
        if item is None:
            return
        if not self.vehicle.told_of_old_request:
            self.vehicle.told_of_old_request = True
            note = "got MISSION_REQUEST; use MISSION_REQUEST_INT!"
            self.vehicle.text(WARNING, note, port)
        answer = mavlink.MAVLink_mission_item_message(
            m.get_srcSystem(), m.get_srcComponent(), m.seq, item.frame, item.command,
            0, 1 if m.mission_type == MISSION else 0, *item.params,
            item.x * 1e-7, item.y * 1e-7, item.z_m, m.mission_type,
        )  # fmt: skip
        self.vehicle.send(port, answer)

    def _wanted(self, m: Message, port: int) -> Item | None:
        kind = m.mission_type
        if not self._type_carried(m, port):
            return None
        if self.busy(kind):
            self._ack(m, port, mavlink.MAV_MISSION_DENIED)
            return None
        if kind == MISSION and m.seq == 0:
            return kinds.with_home(self.vehicle.home_item())
        if m.seq >= self.vehicle.store.count(kind):
            self._send_count(m, port)
            self._ack(m, port, mavlink.MAV_MISSION_ERROR)
            return None
        return self.vehicle.store.lists[kind][m.seq]

    def _type_carried(self, m: Message, port: int) -> bool:
        if m.mission_type not in (MISSION, FENCE, RALLY):
            self._ack(m, port, mavlink.MAV_MISSION_UNSUPPORTED)
            return False
        if m.mission_type != MISSION and self.vehicle.ports[port].mavlink1:
            self.vehicle.text(WARNING, "Need mavlink2 for item transfer", port)
            self._ack(m, port, mavlink.MAV_MISSION_UNSUPPORTED)
            return False
        return True

    def _ack(self, m: Message, port: int, result: int) -> None:
        ack = mavlink.MAVLink_mission_ack_message(
            m.get_srcSystem(), m.get_srcComponent(), result, m.mission_type
        )
        self.vehicle.send(port, ack)
