"""Commands: sent until acknowledged, with the vehicle's own reason when refused."""

from __future__ import annotations

from collections.abc import Callable

from jfto_mavlink.dialect import enum_name, mavlink, mode_name
from jfto_mavlink.errors import CommandError
from jfto_mavlink.protocol.exchange import (
    Context,
    Exchange,
    Send,
    Wait,
    wait_for,
    wait_until,
)
from jfto_msgs_py.retry import Retry

# Texts such as "Arm: Battery 1 below minimum arming voltage" follow the refusal within this time.
REASON_WAIT_S = 0.3
PROGRESS_WAIT_S = 10.0
REJECTED_WAIT_S = 1.0
SEEN_ROUNDS = 3
RETRY = Retry(ceiling_s=2.0, tries=12)

_CODES = {
    mavlink.MAV_RESULT_DENIED: 502,
    mavlink.MAV_RESULT_FAILED: 503,
    mavlink.MAV_RESULT_UNSUPPORTED: 504,
    mavlink.MAV_RESULT_TEMPORARILY_REJECTED: 502,
}


def send_command(
    context: Context,
    command: int,
    params: tuple[float, ...] = (),
    *,
    retry: Retry = RETRY,
    already: Callable[[], bool] | None = None,
) -> Exchange[None]:
    """Send a COMMAND_LONG until it is accepted; return once it is.

    `already` tells whether the vehicle's state shows that the command has worked, for commands that
    a vehicle refuses the second time. Raises CommandError with the vehicle's words.
    """
    name = enum_name("MAV_CMD", command)
    since_s = context.clock()
    values = (*params, *([0.0] * (7 - len(params))))
    result = None
    for confirmation, wait_s in enumerate(retry.waits(context.round_trip.timeout_s)):
        sent_s = context.clock()
        yield Send(
            mavlink.MAVLink_command_long_message(*context.target, command, confirmation, *values)
        )
        result = yield from _result(context, command, sent_s + wait_s)
        if already is not None and already():
            return
        if result == mavlink.MAV_RESULT_ACCEPTED:
            if confirmation == 0:
                context.round_trip.measure(context.clock() - sent_s)
            return
        if result == mavlink.MAV_RESULT_TEMPORARILY_REJECTED:
            yield from wait_until(context, context.clock() + REJECTED_WAIT_S)
        elif result is not None:
            break
    if result is None:
        raise CommandError(
            501,
            f"{context.uav}: no answer to {name} after {confirmation + 1} tries in "
            f"{context.clock() - since_s:.1f} s.",
        )
    yield from wait_until(context, context.clock() + REASON_WAIT_S)
    reasons = tuple(context.vehicle.texts_since(since_s))
    raise CommandError(
        _CODES.get(result, 503),
        f"{context.uav}: {name} answered {enum_name('MAV_RESULT', result)}.",
        reasons,
    )


def _result(context: Context, command: int, until_s: float) -> Exchange[int | None]:
    """Result of a command, None if no answer comes in time; progress reports prolong the wait."""
    while context.clock() < until_s:
        message = yield Wait(until_s)
        if message is None or message.get_type() != "COMMAND_ACK":
            continue
        if message.command != command or not context.addressed(message):
            continue
        if message.result == mavlink.MAV_RESULT_IN_PROGRESS:
            until_s = context.clock() + PROGRESS_WAIT_S
            continue
        return message.result
    return None


def request_message(context: Context, message_id: int) -> Exchange[None]:
    """Ask for one message."""
    yield from send_command(context, mavlink.MAV_CMD_REQUEST_MESSAGE, (float(message_id),))


def command_seen(
    context: Context,
    command: int,
    params: tuple[float, ...],
    seen: Callable[[], bool],
    what: str,
    wait_s: float = 3.0,
) -> Exchange[None]:
    """Send a command until the vehicle's state shows that it worked.

    An acknowledgement may be the late answer to an earlier command of the same kind, so it proves
    nothing by itself. Raises CommandError, 505 if it is accepted but never seen to work.
    """
    since_s = context.clock()
    for _ in range(SEEN_ROUNDS):
        yield from send_command(context, command, params, already=seen)
        if (yield from wait_for(context, seen, wait_s)):
            return
    raise CommandError(
        505,
        f"{context.uav}: {enum_name('MAV_CMD', command)} accepted {SEEN_ROUNDS} times, but it is "
        f"not {what}.",
        tuple(context.vehicle.texts_since(since_s)),
    )


def set_mode(context: Context, mode: int) -> Exchange[None]:
    """Change the flight mode and see it in a heartbeat; raises CommandError."""
    context.ordered_mode = mode
    yield from command_seen(
        context,
        mavlink.MAV_CMD_DO_SET_MODE,
        (float(mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED), float(mode)),
        lambda: context.vehicle.mode == mode,
        f"in mode {mode_name(mode)}",
    )
