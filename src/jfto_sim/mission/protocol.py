"""The mission transfer protocol as ArduCopter 4.5.5 answers it, one upload at a time per list."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from jfto_sim.dialect import DEBUG, INFO, WARNING, Message, mavlink
from jfto_sim.mission import items as kinds
from jfto_sim.mission.items import Item
from jfto_sim.mission.reading import MissionReading
from jfto_sim.mission.store import (
    CAPACITY,
    FENCE,
    MISSION,
    RALLY,
    RALLY_POINT,
    fence_fault,
    fence_size,
)

if TYPE_CHECKING:
    from jfto_sim.vehicle import Vehicle

REPEAT_S = 1.0
GIVE_UP_S = 8.0


@dataclass
class Upload:
    """A transfer to the vehicle in progress; `last` is the seq that ends it."""

    port: int
    system: int
    component: int
    next_seq: int
    last: int
    heard_s: float
    asked_s: float
    told_of_float: bool = False
    gathered: list[Item] = field(default_factory=list)


class MissionProtocol(MissionReading):
    """Answers MISSION_* messages; `tick` repeats requests and gives up after 8 seconds."""

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        self.uploads: dict[int, Upload] = {}

    def busy(self, kind: int) -> bool:
        """Whether a list is being written."""
        return kind in self.uploads

    def handle(self, message: Message, port: int) -> None:
        """Take one message of the mission protocol."""
        getattr(self, "_on_" + message.get_type().lower())(message, port)

    def _on_mission_count(self, m: Message, port: int) -> None:
        kind = m.mission_type
        if not self._type_carried(m, port):
            return
        open_upload = self.uploads.get(kind)
        sender = (m.get_srcSystem(), m.get_srcComponent())
        if open_upload and (open_upload.system, open_upload.component) != sender:
            self._ack(m, port, mavlink.MAV_MISSION_DENIED)
            return
        self.uploads.pop(kind, None)
        if m.count > CAPACITY[kind]:
            self._ack(m, port, mavlink.MAV_MISSION_NO_SPACE)
            self.vehicle.text(WARNING, f"Only {CAPACITY[kind]} items are supported", port)
            return
        if kind == MISSION and self.vehicle.store.truncate(m.count):
            self.vehicle.mission_changed()
        if m.count == 0:
            self._finished(m, port, kind, [])
            return
        self._begin(m, port, 0, m.count - 1)

    def _on_mission_write_partial_list(self, m: Message, port: int) -> None:
        if not self._type_carried(m, port):
            return
        if m.mission_type in self.uploads:
            self._ack(m, port, mavlink.MAV_MISSION_DENIED)
            return
        if m.mission_type != MISSION or not self._range_fits(m):
            self.vehicle.text(WARNING, "Flight plan update rejected", port)
            self._ack(m, port, mavlink.MAV_MISSION_ERROR)
            return
        self._begin(m, port, m.start_index, m.end_index)

    def _range_fits(self, m: Message) -> bool:
        count = self.vehicle.store.count(m.mission_type)
        return 0 <= m.start_index <= m.end_index < count

    def _begin(self, m: Message, port: int, first: int, last: int) -> None:
        now = self.vehicle.time_s
        upload = Upload(port, m.get_srcSystem(), m.get_srcComponent(), first, last, now, now)
        self.uploads[m.mission_type] = upload
        self._ask(m.mission_type, upload)

    def _ask(self, kind: int, upload: Upload) -> None:
        upload.asked_s = self.vehicle.time_s
        request = mavlink.MAVLink_mission_request_message(
            upload.system, upload.component, upload.next_seq, kind
        )
        self.vehicle.send(upload.port, request)

    def _on_mission_item_int(self, m: Message, port: int) -> None:
        if m.mission_type not in (MISSION, FENCE, RALLY):
            self._ack(m, port, mavlink.MAV_MISSION_UNSUPPORTED)
            return
        kind = m.mission_type
        upload = self.uploads.get(kind)
        if upload is None:
            self._ack(m, port, mavlink.MAV_MISSION_ERROR)
            return
        if (upload.system, upload.component) != (m.get_srcSystem(), m.get_srcComponent()):
            self._ack(m, port, mavlink.MAV_MISSION_DENIED)
            return
        if m.seq != upload.next_seq:
            self._ack(m, port, mavlink.MAV_MISSION_INVALID_SEQUENCE)
            return
        fault = self._store_item(m, upload)
        if fault:
            self.uploads.pop(kind, None)
            self._ack(m, port, fault)
            return
        upload.heard_s = self.vehicle.time_s
        if m.seq >= upload.last:
            self._complete(m, port, upload)
            return
        upload.next_seq += 1
        self._ask(kind, upload)

    def _on_mission_item(self, m: Message, port: int) -> None:
        upload = self.uploads.get(m.mission_type)
        if m.mission_type == MISSION and upload and not upload.told_of_float:
            upload.told_of_float = True
            note = "got MISSION_ITEM; GCS should send MISSION_ITEM_INT"
            self.vehicle.text(WARNING, note, port)
        self._on_mission_item_int(m, port)

    def _gather(self, m: Message, upload: Upload) -> int:
        """Keep a fence or rally item until the upload is complete."""
        known = m.command == RALLY_POINT if m.mission_type == RALLY else 5000 <= m.command < 5005
        if not known:
            return mavlink.MAV_MISSION_UNSUPPORTED
        place = kinds.place_of(m)
        if place is None:
            return mavlink.MAV_MISSION_INVALID_PARAM5_X
        params = (m.param1, m.param2, m.param3, m.param4)
        frame = kinds.GLOBAL if m.mission_type == FENCE else kinds.RELATIVE
        upload.gathered.append(Item(m.command, frame, params, *place, m.z))
        return 0

    def _store_item(self, m: Message, upload: Upload) -> int:
        if m.mission_type != MISSION:
            return self._gather(m, upload)
        item, fault = kinds.parse(m)
        if item is None:
            return fault
        if item.command == kinds.JUMP:
            target = item.params[0]
            if target == 0 or target > max(upload.last, self.vehicle.store.count(MISSION) - 1):
                return mavlink.MAV_MISSION_ERROR
        if m.seq > self.vehicle.store.count(MISSION):
            return mavlink.MAV_MISSION_ERROR
        self.vehicle.store.put(m.seq, item)
        self.vehicle.mission_changed()
        return 0

    def _complete(self, m: Message, port: int, upload: Upload) -> None:
        self.uploads.pop(m.mission_type, None)
        fault = fence_fault(upload.gathered) if m.mission_type == FENCE else ""
        if fault:
            self._ack(m, port, mavlink.MAV_MISSION_ERROR)
            self.vehicle.text(WARNING, fault)
            self.vehicle.text(WARNING, "Fence validation failed")
            return
        self._finished(m, port, m.mission_type, upload.gathered)

    def _finished(self, m: Message, port: int, kind: int, items: list[Item]) -> None:
        self._ack(m, port, mavlink.MAV_MISSION_ACCEPTED)
        if kind == MISSION:
            self.vehicle.text(INFO, "Flight plan received", port)
        else:
            self._replace(kind, items)

    def _replace(self, kind: int, items: list[Item]) -> None:
        v = self.vehicle
        v.store.replace(kind, items)
        if kind == FENCE:
            v.text(DEBUG, "Fence Indexed OK")
        name = "FENCE_TOTAL" if kind == FENCE else "RALLY_TOTAL"
        v.params.store(name, len(items) if kind == RALLY else fence_size(items))
        v.tell_parameter(name)

    @property
    def next_s(self) -> float:
        """When a request is to be repeated, or an upload to be given up."""
        return min(
            (min(u.asked_s + REPEAT_S, u.heard_s + GIVE_UP_S) for u in self.uploads.values()),
            default=float("inf"),
        )

    def tick(self) -> None:
        """Repeat unanswered requests every second, give up 8 s after the last accepted item."""
        now = self.vehicle.time_s
        for kind, upload in list(self.uploads.items()):
            if now - upload.heard_s >= GIVE_UP_S - 1e-6:
                del self.uploads[kind]
                done = mavlink.MAVLink_mission_ack_message(
                    upload.system,
                    upload.component,
                    mavlink.MAV_MISSION_OPERATION_CANCELLED,
                    kind,
                )
                self.vehicle.send(upload.port, done)
                self.vehicle.text(WARNING, "Mission upload timeout", upload.port)
            elif now - upload.asked_s >= REPEAT_S - 1e-6:
                self._ask(kind, upload)

    def _on_mission_clear_all(self, m: Message, port: int) -> None:
        if not self._type_carried(m, port):
            return
        kind = m.mission_type
        if kind in self.uploads or (kind == MISSION and self.vehicle.mission_busy):
            self._ack(m, port, mavlink.MAV_MISSION_ERROR)
            return
        self._ack(m, port, mavlink.MAV_MISSION_ACCEPTED)
        if kind == MISSION:
            self.vehicle.store.truncate(0)
            self.vehicle.mission_changed()
        else:
            self._replace(kind, [])

    def _on_mission_set_current(self, m: Message, port: int) -> None:
        if self.vehicle.set_mission_current(m.seq):
            self.vehicle.send_now(port, mavlink.MAVLINK_MSG_ID_MISSION_CURRENT)

    def _on_mission_ack(self, m: Message, port: int) -> None:
        """The station's receipt after a read-back changes nothing here."""
