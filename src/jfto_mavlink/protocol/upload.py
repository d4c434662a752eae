"""The upload protocol as ArduCopter really behaves (measured on 4.5.5).

The vehicle asks for each item with MISSION_REQUEST and is answered with MISSION_ITEM_INT. By itself
it repeats a question only after 1 s. So when no question comes within the link's round-trip time,
the last item is sent again *and the next one with it*: whichever of item and question was lost, one
of the two is what the vehicle waits for, and it answers the other with INVALID_SEQUENCE, which is
not a failure.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from jfto_mavlink.dialect import Message, mavlink
from jfto_mavlink.errors import TransferError
from jfto_mavlink.protocol.exchange import Context, Exchange, Report, Send, Wait
from jfto_mavlink.protocol.item import MISSION, TYPE_NAMES, Item
from jfto_mavlink.protocol.transfer import (
    ACCEPTED,
    BUSY,
    CANCELLED,
    ERROR,
    OUT_OF_SEQUENCE,
    POLICY,
    TransferPolicy,
    ack_name,
    ack_type,
    is_of,
)

_REQUESTS = ("MISSION_REQUEST", "MISSION_REQUEST_INT")


class Outcome(Enum):
    """How an upload ended that was not refused."""

    ACCEPTED = "accepted"
    # The last item was sent, the final answer was lost: only reading back can tell.
    UNCERTAIN = "uncertain"


def upload(
    context: Context,
    items: Sequence[Item],
    mission_type: int = MISSION,
    policy: TransferPolicy = POLICY,
) -> Exchange[Outcome]:
    """Send a mission. Raises TransferError 401 (refused), 402 (busy) or 403 (no answer).

    After any error the vehicle may hold half of the new mission: nothing is rolled back there.
    """
    return (yield from _Upload(context, items, mission_type, policy).run())


@dataclass
class _Upload:
    """Where an upload stands; `asked` is the item last asked for, None before the first.

    `progress_s` is when the vehicle last asked for anything, or when the mission was announced.
    """

    context: Context
    items: Sequence[Item]
    mission_type: int
    policy: TransferPolicy
    asked: int | None = None
    last_sent: bool = False
    starts: int = 1
    busy_since_s: float | None = None

    def __post_init__(self) -> None:
        self.begun_s = self.progress_s = self.resend_s = self.context.clock()
        self.wait_s = self.context.round_trip.timeout_s

    def run(self) -> Exchange[Outcome]:
        """The whole conversation."""
        context = self.context
        yield from self._start()
        while True:
            message = yield Wait(self.resend_s)
            if message is not None and self._is_request(message):
                yield from self._answer(message.seq)
                continue
            code = None if message is None else ack_type(context, message, self.mission_type)
            outcome = None if code is None else (yield from self._acknowledged(code))
            if outcome is None and context.clock() >= self.resend_s:
                outcome = yield from self._silence(context.clock())
            if outcome is not None:
                return outcome

    def _is_request(self, message: Message) -> bool:
        return is_of(self.context, message, self.mission_type, *_REQUESTS) and (
            0 <= message.seq < len(self.items)
        )

    def _start(self, wait_s: float | None = None) -> Exchange[None]:
        """Announce the mission; the vehicle begins to ask from item 0."""
        context = self.context
        self.asked, self.last_sent = None, False
        self.wait_s = wait_s or context.round_trip.timeout_s
        self.resend_s = context.clock() + self.wait_s
        yield Send(
            mavlink.MAVLink_mission_count_message(
                *context.target, len(self.items), self.mission_type
            )
        )

    def _answer(self, seq: int) -> Exchange[None]:
        now_s = self.context.clock()
        self.progress_s = now_s
        self.busy_since_s = None
        if self.asked != seq:
            self.asked = seq
            self.wait_s = self.context.round_trip.timeout_s
        self.resend_s = now_s + self.wait_s
        yield from self._send_item(seq)
        yield Report(f"{TYPE_NAMES[self.mission_type]} upload", seq + 1, len(self.items))

    def _send_item(self, seq: int) -> Exchange[None]:
        self.last_sent |= seq == len(self.items) - 1
        yield Send(self.items[seq].to_message(*self.context.target, seq, self.mission_type))

    def _silence(self, now_s: float) -> Exchange[Outcome | None]:
        """No question came in time: ask for one, or conclude."""
        policy = self.policy
        alive_s = max(self.begun_s, self.context.vehicle.heard_s or 0.0)
        if now_s - alive_s > policy.ask.limit_s:
            raise self._error(403, f"silent for {policy.ask.limit_s:g} s")
        # Longer and longer, so that a slow link is not filled with copies.
        self.wait_s = policy.ask.longer_s(self.wait_s)
        if self.asked is None:
            if now_s - self.progress_s > policy.ask.limit_s and self.busy_since_s is None:
                raise self._error(403, f"not answered for {policy.ask.limit_s:g} s")
            yield from self._start(self.wait_s)
            return None
        if now_s - self.progress_s > policy.silence_s:
            # Longer than the vehicle keeps an upload open.
            if self.last_sent:
                return Outcome.UNCERTAIN
            yield from self._start_over(403, "no question for longer than an upload stays open")
            return None
        self.resend_s = now_s + self.wait_s
        asked = self.asked
        yield from self._send_item(asked)
        if asked + 1 < len(self.items):
            yield from self._send_item(asked + 1)
        return None

    def _start_over(self, code: int, why: str) -> Exchange[None]:
        if self.starts >= self.policy.starts:
            raise self._error(code, f"tried {self.starts} times: {why}", self.asked)
        self.starts += 1
        self.progress_s = self.context.clock()
        yield Report(f"{TYPE_NAMES[self.mission_type]} upload starts over: {why}")
        yield from self._start()

    def _acknowledged(self, code: int) -> Exchange[Outcome | None]:
        """React to a MISSION_ACK; an outcome ends the upload."""
        finished = self.last_sent or not self.items
        if code == ACCEPTED:
            # Before the last item was sent this is the echo of an earlier transfer.
            return Outcome.ACCEPTED if finished else None
        if code == BUSY:
            yield from self._busy()
        elif code == ERROR and finished:
            # The answer to a copy of the last item: the upload is closed, one way or other.
            return Outcome.UNCERTAIN
        elif code in (ERROR, CANCELLED):
            # With nothing asked yet it answers items of the try before.
            if self.asked is not None:
                yield from self._start_over(401, f"ended by the vehicle with {ack_name(code)}")
        elif code != OUT_OF_SEQUENCE:
            raise self._error(401, f"refused: {ack_name(code)}", self.asked)
        return None

    def _busy(self) -> Exchange[None]:
        """Another station's upload is open: wait for our turn (unless ours is the open one)."""
        now_s = self.context.clock()
        if self.asked is not None:
            return
        if self.busy_since_s is None:
            self.busy_since_s = now_s
            yield Report("waiting: another station is writing this vehicle's mission")
        if now_s - self.busy_since_s > self.policy.busy.limit_s:
            raise self._error(
                402, f"kept out by another station for {self.policy.busy.limit_s:g} s"
            )
        self.resend_s = now_s + self.policy.busy.first_s

    def _error(self, code: int, reason: str, item: int | None = None) -> TransferError:
        place = "" if item is None else f" at item {item}"
        texts = self.context.vehicle.texts_since(self.begun_s)
        words = "".join(f' "{text}"' for text in texts)
        name = TYPE_NAMES[self.mission_type]
        return TransferError(code, f"{self.context.uav}: {name} upload {reason}{place}.{words}")
