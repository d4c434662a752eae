"""The mission transfer protocol as ArduCopter 4.5.5 answers it, one upload at a time per list."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

from jfto_sim.clock import Clock
from jfto_sim.dialect import DEBUG, INFO, WARNING, Message, mavlink
from jfto_sim.mission import items as kinds
from jfto_sim.mission.fence import fence_fault, fence_size
from jfto_sim.mission.items import CAPACITY, FENCE, MISSION, RALLY, WAYPOINT, Item, Store
from jfto_sim.parameters import ParameterProtocol
from jfto_sim.ports import MessageHandler, Ports
from jfto_sim.position import Position

REPEAT_S = 1.0
GIVE_UP_S = 8.0
_RALLY_POINT = 5100


class MissionFlyer(Protocol):
    """What flies the stored mission: AUTO mode."""

    @property
    def on_mission(self) -> bool:
        """Whether the mission is being flown and may not be cleared."""

    def mission_edited(self) -> None:
        """An item was stored or the mission shortened."""

    def set_current(self, seq: int) -> bool:
        """Make an item the current one; false if there is no such item."""

    def send_current(self, port: int) -> None:
        """Send MISSION_CURRENT."""


@dataclass
class Upload:
    """A transfer to the vehicle in progress; `last` is the seq that ends it."""

    port: int
    system: int
    component: int
    next_seq: int
    last: int
    received_s: float
    asked_s: float
    warned_of_float: bool = False
    gathered: list[Item] = field(default_factory=list)

    def is_from(self, m: Message) -> bool:
        """Whether a message comes from the station that uploads."""
        return (self.system, self.component) == (m.get_srcSystem(), m.get_srcComponent())


@dataclass
class MissionProtocol:
    """Answers MISSION_* messages; `tick` repeats requests and gives up after 8 seconds.

    `uploads` are the transfers in progress by mission type: a list that is being written is not
    read back.
    """

    clock: Clock
    ports: Ports
    store: Store
    parameters: ParameterProtocol
    position: Position
    flyer: MissionFlyer
    uploads: dict[int, Upload] = field(default_factory=dict)
    _warned_of_old_request: bool = False

    def __post_init__(self) -> None:
        self.messages: dict[str, MessageHandler] = {
            "MISSION_COUNT": self._count,
            "MISSION_WRITE_PARTIAL_LIST": self._write_partial_list,
            "MISSION_ITEM_INT": self._item_int,
            "MISSION_ITEM": self._item,
            "MISSION_CLEAR_ALL": self._clear_all,
            "MISSION_SET_CURRENT": self._set_current,
            "MISSION_REQUEST_LIST": self._request_list,
            "MISSION_REQUEST_INT": self._request_int,
            "MISSION_REQUEST": self._request,
        }

    # --- uploads ---

    def _count(self, m: Message, port: int) -> None:
        kind = m.mission_type
        if not self._type_carried(m, port):
            return
        upload = self.uploads.get(kind)
        if upload and not upload.is_from(m):
            self._ack(m, port, mavlink.MAV_MISSION_DENIED)
            return
        self.uploads.pop(kind, None)
        if m.count > CAPACITY[kind]:
            self._ack(m, port, mavlink.MAV_MISSION_NO_SPACE)
            self.ports.text(WARNING, f"Only {CAPACITY[kind]} items are supported", port)
            return
        if kind == MISSION and self.store.truncate(m.count):
            self._mission_changed()
        if m.count == 0:
            self._finished(m, port, kind, [])
            return
        self._begin(m, port, 0, m.count - 1)

    def _write_partial_list(self, m: Message, port: int) -> None:
        if not self._type_carried(m, port):
            return
        if m.mission_type in self.uploads:
            self._ack(m, port, mavlink.MAV_MISSION_DENIED)
            return
        fits = 0 <= m.start_index <= m.end_index < self.store.count(m.mission_type)
        if m.mission_type != MISSION or not fits:
            self.ports.text(WARNING, "Flight plan update rejected", port)
            self._ack(m, port, mavlink.MAV_MISSION_ERROR)
            return
        self._begin(m, port, m.start_index, m.end_index)

    def _begin(self, m: Message, port: int, first: int, last: int) -> None:
        now = self.clock.time_s
        upload = Upload(port, m.get_srcSystem(), m.get_srcComponent(), first, last, now, now)
        self.uploads[m.mission_type] = upload
        self._ask(m.mission_type, upload)

    def _ask(self, kind: int, upload: Upload) -> None:
        upload.asked_s = self.clock.time_s
        request = mavlink.MAVLink_mission_request_message(
            upload.system, upload.component, upload.next_seq, kind
        )
        self.ports.send(upload.port, request)

    def _item_int(self, m: Message, port: int) -> None:
        kind = m.mission_type
        if kind not in (MISSION, FENCE, RALLY):
            self._ack(m, port, mavlink.MAV_MISSION_UNSUPPORTED)
            return
        upload = self.uploads.get(kind)
        if upload is None:
            self._ack(m, port, mavlink.MAV_MISSION_ERROR)
            return
        if not upload.is_from(m):
            self._ack(m, port, mavlink.MAV_MISSION_DENIED)
            return
        if m.seq != upload.next_seq:
            self._ack(m, port, mavlink.MAV_MISSION_INVALID_SEQUENCE)
            return
        fault = self._keep(m, upload) if kind == MISSION else _gather(m, upload)
        if fault:
            self.uploads.pop(kind, None)
            self._ack(m, port, fault)
            return
        upload.received_s = self.clock.time_s
        if m.seq >= upload.last:
            self._complete(m, port, upload)
            return
        upload.next_seq += 1
        self._ask(kind, upload)

    def _item(self, m: Message, port: int) -> None:
        upload = self.uploads.get(m.mission_type)
        if m.mission_type == MISSION and upload and not upload.warned_of_float:
            upload.warned_of_float = True
            note = "got MISSION_ITEM; GCS should send MISSION_ITEM_INT"
            self.ports.text(WARNING, note, port)
        self._item_int(m, port)

    def _keep(self, m: Message, upload: Upload) -> int:
        """Store a mission item; what is wrong with it, 0 if nothing."""
        item, fault = kinds.parse(m)
        if item is None:
            return fault
        count = self.store.count(MISSION)
        if item.command == kinds.JUMP:
            target = item.params[0]
            if target == 0 or target > max(upload.last, count - 1):
                return mavlink.MAV_MISSION_ERROR
        if m.seq > count:
            return mavlink.MAV_MISSION_ERROR
        self.store.put(m.seq, item)
        self._mission_changed()
        return 0

    def _complete(self, m: Message, port: int, upload: Upload) -> None:
        self.uploads.pop(m.mission_type, None)
        fault = fence_fault(upload.gathered) if m.mission_type == FENCE else ""
        if fault:
            self._ack(m, port, mavlink.MAV_MISSION_ERROR)
            self.ports.text(WARNING, fault)
            self.ports.text(WARNING, "Fence validation failed")
            return
        self._finished(m, port, m.mission_type, upload.gathered)

    def _finished(self, m: Message, port: int, kind: int, items: list[Item]) -> None:
        self._ack(m, port, mavlink.MAV_MISSION_ACCEPTED)
        if kind == MISSION:
            self.ports.text(INFO, "Flight plan received", port)
        else:
            self._replace(kind, items)

    def _replace(self, kind: int, items: list[Item]) -> None:
        self.store.replace(kind, items)
        if kind == FENCE:
            self.ports.text(DEBUG, "Fence Indexed OK")
            self.parameters.store_and_announce("FENCE_TOTAL", fence_size(items))
        else:
            self.parameters.store_and_announce("RALLY_TOTAL", len(items))

    def _mission_changed(self) -> None:
        count = float(self.store.count(MISSION))
        if self.parameters.params["MIS_TOTAL"] != count:
            self.parameters.store_and_announce("MIS_TOTAL", count)
        self.flyer.mission_edited()

    @property
    def next_s(self) -> float:
        """When a request is to be repeated, or an upload to be given up."""
        return min(
            (min(u.asked_s + REPEAT_S, u.received_s + GIVE_UP_S) for u in self.uploads.values()),
            default=float("inf"),
        )

    def tick(self) -> None:
        """Repeat unanswered requests every second, give up 8 s after the last accepted item."""
        now = self.clock.time_s
        for kind, upload in list(self.uploads.items()):
            if now - upload.received_s >= GIVE_UP_S - 1e-6:
                del self.uploads[kind]
                cancelled = mavlink.MAV_MISSION_OPERATION_CANCELLED
                sender = (upload.system, upload.component)
                self.ports.send(
                    upload.port, mavlink.MAVLink_mission_ack_message(*sender, cancelled, kind)
                )
                self.ports.text(WARNING, "Mission upload timeout", upload.port)
            elif now - upload.asked_s >= REPEAT_S - 1e-6:
                self._ask(kind, upload)

    def _clear_all(self, m: Message, port: int) -> None:
        kind = m.mission_type
        if not self._type_carried(m, port):
            return
        if kind in self.uploads or (kind == MISSION and self.flyer.on_mission):
            self._ack(m, port, mavlink.MAV_MISSION_ERROR)
            return
        self._ack(m, port, mavlink.MAV_MISSION_ACCEPTED)
        if kind == MISSION:
            self.store.truncate(0)
            self._mission_changed()
        else:
            self._replace(kind, [])

    def _set_current(self, m: Message, port: int) -> None:
        if self.flyer.set_current(m.seq):
            self.flyer.send_current(port)

    # --- reading back ---

    def _request_list(self, m: Message, port: int) -> None:
        if self._readable(m, port):
            self._send_count(m, port)

    def _send_count(self, m: Message, port: int) -> None:
        count = self.store.count(m.mission_type)
        reader = (m.get_srcSystem(), m.get_srcComponent())
        self.ports.send(port, mavlink.MAVLink_mission_count_message(*reader, count, m.mission_type))

    def _request_int(self, m: Message, port: int) -> None:
        item = self._wanted(m, port)
        if item is not None:
            self._send_item(mavlink.MAVLink_mission_item_int_message, m, port, item, 1)

    def _request(self, m: Message, port: int) -> None:
        item = self._wanted(m, port)
        if item is None:
            return
        if not self._warned_of_old_request:
            self._warned_of_old_request = True
            note = "got MISSION_REQUEST; use MISSION_REQUEST_INT!"
            self.ports.text(WARNING, note, port)
        self._send_item(mavlink.MAVLink_mission_item_message, m, port, item, 1e-7)

    def _send_item(self, form: type, m: Message, port: int, item: Item, scale: float) -> None:
        answer = form(
            m.get_srcSystem(), m.get_srcComponent(), m.seq, item.frame, item.command,
            0, 1 if m.mission_type == MISSION else 0, *item.params,
            item.x * scale, item.y * scale, item.z_m, m.mission_type,
        )  # fmt: skip
        self.ports.send(port, answer)

    def _wanted(self, m: Message, port: int) -> Item | None:
        kind = m.mission_type
        if not self._readable(m, port):
            return None
        if kind == MISSION and m.seq == 0:
            lat, lon, alt_m = self.position.home()
            return Item(WAYPOINT, x=lat, y=lon, z_m=alt_m)
        if m.seq >= self.store.count(kind):
            self._send_count(m, port)
            self._ack(m, port, mavlink.MAV_MISSION_ERROR)
            return None
        return self.store.lists[kind][m.seq]

    def _readable(self, m: Message, port: int) -> bool:
        if not self._type_carried(m, port):
            return False
        if m.mission_type in self.uploads:
            self._ack(m, port, mavlink.MAV_MISSION_DENIED)
            return False
        return True

    def _type_carried(self, m: Message, port: int) -> bool:
        if m.mission_type not in (MISSION, FENCE, RALLY):
            self._ack(m, port, mavlink.MAV_MISSION_UNSUPPORTED)
            return False
        if m.mission_type != MISSION and self.ports[port].mavlink1:
            self.ports.text(WARNING, "Need mavlink2 for item transfer", port)
            self._ack(m, port, mavlink.MAV_MISSION_UNSUPPORTED)
            return False
        return True

    def _ack(self, m: Message, port: int, result: int) -> None:
        sender = (m.get_srcSystem(), m.get_srcComponent())
        self.ports.send(port, mavlink.MAVLink_mission_ack_message(*sender, result, m.mission_type))


def _gather(m: Message, upload: Upload) -> int:
    """Keep a fence or rally item until the upload is complete; what is wrong, 0 if nothing."""
    known = m.command == _RALLY_POINT if m.mission_type == RALLY else 5000 <= m.command < 5005
    if not known:
        return mavlink.MAV_MISSION_UNSUPPORTED
    place = kinds.place_of(m)
    if place is None:
        return mavlink.MAV_MISSION_INVALID_PARAM5_X
    params = (m.param1, m.param2, m.param3, m.param4)
    frame = kinds.GLOBAL if m.mission_type == FENCE else kinds.RELATIVE
    upload.gathered.append(Item(m.command, frame, params, *place, m.z))
    return 0
