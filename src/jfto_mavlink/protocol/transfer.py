"""Missions on their way: what an acknowledgement means, patience, and reading one back.

Several questions of a read-back are in flight at a time.
"""

from __future__ import annotations

from dataclasses import dataclass

from jfto_mavlink.dialect import Message, enum_name, mavlink
from jfto_mavlink.errors import TransferError
from jfto_mavlink.protocol.exchange import Context, Exchange, Report, Send, Wait
from jfto_mavlink.protocol.item import MISSION, TYPE_NAMES, Item, item_from_message
from jfto_msgs_py.retry import Retry

ACCEPTED = mavlink.MAV_MISSION_ACCEPTED
ERROR = mavlink.MAV_MISSION_ERROR
BUSY = mavlink.MAV_MISSION_DENIED
CANCELLED = mavlink.MAV_MISSION_OPERATION_CANCELLED
OUT_OF_SEQUENCE = mavlink.MAV_MISSION_INVALID_SEQUENCE


_ASK = Retry(ceiling_s=1.0, limit_s=30.0)
_BUSY = Retry(first_s=1.5, ceiling_s=1.5, limit_s=60.0)


@dataclass(frozen=True)
class TransferPolicy:
    """How patient a transfer is, in seconds of the vehicle's clock.

    `ask` is for questions and items unanswered, `busy` for a vehicle that another station is
    writing to. ArduCopter asks for a missing item every 1.0 s and gives an upload up 8.0 s after
    the last good item: so long another station's abandoned upload blocks ours, and after
    `silence_s` an upload of ours is no longer open. It is started at most `starts` times; `window`
    questions of a read-back are in flight at a time.
    """

    ask: Retry = _ASK
    busy: Retry = _BUSY
    silence_s: float = 9.5
    starts: int = 6
    window: int = 4


POLICY = TransferPolicy()


def is_of(context: Context, message: Message, mission_type: int, *kinds: str) -> bool:
    """Whether a message is of one of the kinds, meant for us and of this type of mission."""
    return (
        message.get_type() in kinds
        and message.mission_type == mission_type
        and context.addressed(message)
    )


def ack_type(context: Context, message: Message, mission_type: int) -> int | None:
    """Type of a MISSION_ACK that is meant for us and for this type of mission, else None."""
    return message.type if is_of(context, message, mission_type, "MISSION_ACK") else None


def ack_name(code: int) -> str:
    """Name of a MISSION_ACK type without its prefix."""
    return enum_name("MAV_MISSION_RESULT", code).removeprefix("MAV_MISSION_")


def download(
    context: Context, mission_type: int = MISSION, policy: TransferPolicy = POLICY
) -> Exchange[tuple[Item, ...]]:
    """Items on board. Raises TransferError 402 (busy) or 403 (no answer)."""
    return (yield from read_back(context, mission_type, policy)).items


@dataclass
class ReadBack:
    """Items on board, and whether another station was writing while they were read."""

    items: tuple[Item, ...] = ()
    contested: bool = False


def read_back(context: Context, mission_type: int, policy: TransferPolicy) -> Exchange[ReadBack]:
    """Like `download`, and whether other stations write."""
    found = ReadBack()
    count = yield from _count(context, mission_type, policy, found)
    found.items = yield from _items(context, mission_type, count, policy, found)
    yield Send(mavlink.MAVLink_mission_ack_message(*context.target, ACCEPTED, mission_type))
    return found


def _count(
    context: Context, mission_type: int, policy: TransferPolicy, found: ReadBack
) -> Exchange[int]:
    heard_s = busy_s = context.clock()
    waits = policy.ask.waits(context.round_trip.timeout_s)
    while True:
        yield Send(mavlink.MAVLink_mission_request_list_message(*context.target, mission_type))
        until_s = context.clock() + next(waits)
        while context.clock() < until_s:
            message = yield Wait(until_s)
            if message is None:
                continue
            if is_of(context, message, mission_type, "MISSION_COUNT"):
                return message.count
            code = ack_type(context, message, mission_type)
            if code == BUSY:
                found.contested = True
                heard_s = context.clock()
                if heard_s - busy_s > policy.busy.limit_s:
                    raise _error(context, 402, mission_type, "another station holds the mission.")
                until_s = heard_s + policy.busy.first_s
        last_s = max(heard_s, context.vehicle.heard_s or 0.0)
        if context.clock() - last_s > policy.ask.limit_s or context.clock() - heard_s > (
            4 * policy.ask.limit_s
        ):
            raise _error(
                context, 403, mission_type, f"no answer for {context.clock() - heard_s:.0f} s."
            )


def _items(
    context: Context, mission_type: int, count: int, policy: TransferPolicy, found: ReadBack
) -> Exchange[tuple[Item, ...]]:
    """All items, asked for in a window; a question unanswered is asked again after a while."""
    held: dict[int, Item] = {}
    due: dict[int, float] = {}
    wait_s = dict.fromkeys(range(count), context.round_trip.timeout_s)
    progress_s = context.clock()
    shorter = 0
    while len(held) < count:
        now_s = context.clock()
        if now_s - progress_s > policy.ask.limit_s:
            raise _error(
                context, 403, mission_type, f"no item for {policy.ask.limit_s:g} s, at {len(held)}."
            )
        open_items = (seq for seq in range(count) if seq not in held)
        for seq, _ in zip(open_items, range(policy.window), strict=False):
            if due.get(seq, now_s) <= now_s:
                due[seq] = now_s + wait_s[seq]
                wait_s[seq] = policy.ask.longer_s(wait_s[seq])
                yield Send(
                    mavlink.MAVLink_mission_request_int_message(*context.target, seq, mission_type)
                )
        message = yield Wait(min(at for seq, at in due.items() if seq not in held))
        if message is None:
            continue
        code = ack_type(context, message, mission_type)
        if code == BUSY:
            found.contested = True
            for seq in due:
                due[seq] = context.clock() + policy.busy.first_s
        elif is_of(context, message, mission_type, "MISSION_COUNT") and message.count < count:
            # The answer to a question past the end: the list has become shorter meanwhile. A single
            # one may be an old copy.
            shorter += 1
            if shorter > 1:
                raise _error(context, 402, mission_type, "another station changed it meanwhile.")
        elif is_of(context, message, mission_type, "MISSION_ITEM_INT") and message.seq < count:
            if message.seq not in held:
                progress_s = context.clock()
                yield Report(f"{TYPE_NAMES[mission_type]} read back", len(held) + 1, count)
            held[message.seq] = item_from_message(message)
    return tuple(held[seq] for seq in range(count))


def _error(context: Context, code: int, mission_type: int, reason: str) -> TransferError:
    name = TYPE_NAMES[mission_type]
    return TransferError(code, f"{context.uav}: {name} could not be read: {reason}")
