"""One vehicle's mission, delivered: sent, read back, compared, and tidied up after a refusal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from jfto_mavlink.dialect import MODES, mavlink
from jfto_mavlink.errors import TransferError
from jfto_mavlink.mission.stored import differences, mission_hash
from jfto_mavlink.protocol.exchange import Context, Exchange, Report, Send, Wait
from jfto_mavlink.protocol.item import FENCE, MISSION, RALLY, TYPE_NAMES, Item, Mission
from jfto_mavlink.protocol.transfer import (
    ACCEPTED,
    BUSY,
    ERROR,
    POLICY,
    TransferPolicy,
    ack_name,
    ack_type,
    download,
    read_back,
)
from jfto_mavlink.protocol.upload import upload

# Uploads of one mission until read-back must agree.
ROUNDS = 3
CLEAR_TRIES = 12


@dataclass(frozen=True)
class Delivered:
    """Proof that a vehicle holds a mission: the hash, and how long delivery took."""

    uav: str
    digest: str
    duration_s: float


def deliver(
    context: Context, mission: Mission, policy: TransferPolicy = POLICY
) -> Exchange[Delivered]:
    """Send mission, fence and rally points, read each back and compare; no parameter is touched.

    On the ground a refused mission is cleared, so that nothing half-new can be started. In flight
    the one on board before is put back. Raises TransferError whose `state` says which, and 405 in
    AUTO: there, each stored item restarts the leg being flown.
    """
    begun_s = context.clock()
    if context.vehicle.armed and context.vehicle.mode == MODES["AUTO"]:
        raise TransferError(
            405, f"{context.uav}: is flying its mission in AUTO; pause it first (BRAKE)."
        )
    before: tuple[Item, ...] | None = None
    if context.vehicle.armed:
        before = yield from download(context, MISSION, policy)
    try:
        for mission_type in _carried(mission):
            yield from _deliver_type(context, mission.of_type(mission_type), mission_type, policy)
    except TransferError as error:
        if error.code == 402:
            # Not ours to clear.
            state = "What the vehicle holds is the other station's."
            raise TransferError(error.code, _without_code(error), state) from error
        state = yield from _tidy_up(context, before, policy)
        raise TransferError(error.code, _without_code(error), state) from error
    return Delivered(context.uav, mission_hash(mission), context.clock() - begun_s)


def verify(
    context: Context, mission: Mission, policy: TransferPolicy = POLICY
) -> Exchange[tuple[str, ...]]:
    """Differences between a mission and what the vehicle holds, in words; empty if none.

    Parameters are not compared: they are set when a flight begins.
    """
    found: list[str] = []
    for mission_type in _carried(mission):
        held = yield from download(context, mission_type, policy)
        found += differences(mission.of_type(mission_type), held, mission_type)
    return tuple(found)


def clear(context: Context, mission_type: int, policy: TransferPolicy = POLICY) -> Exchange[None]:
    """Remove all items of a type and see that none is left; raises TransferError."""
    name = TYPE_NAMES[mission_type]
    begun_s = context.clock()
    answer = "no answer"
    tries = replace(policy.ask, tries=CLEAR_TRIES)
    for wait_s in tries.waits(context.round_trip.timeout_s):
        yield Send(mavlink.MAVLink_mission_clear_all_message(*context.target, mission_type))
        until_s = context.clock() + wait_s
        while context.clock() < until_s:
            message = yield Wait(until_s)
            code = None if message is None else ack_type(context, message, mission_type)
            if code == ACCEPTED:
                held = yield from download(context, mission_type, policy)
                if len(held) <= (1 if mission_type == MISSION else 0):
                    return
            elif code is not None:
                # Another station's open upload, or a mission being flown.
                answer = ack_name(code)
                until_s = context.clock() + policy.busy.first_s
                if code not in (BUSY, ERROR):
                    raise TransferError(401, f"{context.uav}: {name} not cleared: {answer}.")
        if context.clock() - begun_s > policy.busy.limit_s:
            break
    raise TransferError(403, f"{context.uav}: {name} not cleared: {answer}.")


def _carried(mission: Mission) -> tuple[int, ...]:
    """Mission types to write and compare: a fence or rally points of others stay untouched."""
    optional = tuple(kind for kind in (FENCE, RALLY) if mission.of_type(kind))
    return (*optional, MISSION)


def _deliver_type(
    context: Context, items: Sequence[Item], mission_type: int, policy: TransferPolicy
) -> Exchange[None]:
    name = TYPE_NAMES[mission_type]
    begun_s = context.clock()
    found: tuple[str, ...] = ()
    for attempt in range(ROUNDS):
        if items:
            yield from upload(context, items, mission_type, policy)
        else:
            yield from clear(context, mission_type, policy)
        held = yield from read_back(context, mission_type, policy)
        found = differences(items, held.items, mission_type)
        if not found:
            return
        if held.contested:
            raise TransferError(
                402, f"{context.uav}: {name} was written over by another station after ours."
            )
        yield Report(f"{name} differs after upload {attempt + 1}: {found[0]}")
    words = "".join(f' "{text}"' for text in context.vehicle.texts_since(begun_s))
    raise TransferError(
        404,
        f"{context.uav}: {name} on board differs after {ROUNDS} uploads in {len(found)} places, "
        f"first {found[0]}.{words}",
    )


def _tidy_up(
    context: Context, before: tuple[Item, ...] | None, policy: TransferPolicy
) -> Exchange[str]:
    """Leave a state that can be named: the old mission in flight, none on the ground."""
    try:
        if before is not None and len(before) > 1:
            yield Report("putting the mission back that was on board")
            yield from _deliver_type(context, before, MISSION, policy)
            return "The mission that was on board before is restored."
        yield Report("clearing the half-written mission")
        yield from clear(context, MISSION, policy)
    except TransferError as error:
        return f"What the vehicle holds is unknown ({_without_code(error)}); do not start it."
    return "Its mission is cleared."


def _without_code(error: TransferError) -> str:
    return str(error).rsplit(" [MAV-", 1)[0]
