"""Parameters by name: read, and set with proof that the value was taken."""

from __future__ import annotations

import math

from jfto_mavlink.dialect import Message, mavlink
from jfto_mavlink.errors import CommandError
from jfto_mavlink.protocol.exchange import Context, Exchange, Send, Wait
from jfto_mavlink.protocol.item import float32
from jfto_msgs_py.retry import Retry

RETRY = Retry(ceiling_s=2.0, tries=8)
# ArduPilot answers a read after about 100 ms.
READ_WAIT_S = 0.3


def read_parameter(context: Context, name: str) -> Exchange[float]:
    """Value of a parameter. An unknown name gets no answer at all: CommandError 506."""
    request = mavlink.MAVLink_param_request_read_message(*context.target, name.encode("ascii"), -1)
    return (yield from _ask(context, name, request))


def set_parameter(context: Context, name: str, value: float) -> Exchange[None]:
    """Set a parameter and see the new value come back; raises CommandError 506 or 507.

    ArduPilot checks no range, and a read-only parameter is answered with its old value.
    """
    if not math.isfinite(value):
        raise CommandError(507, f"{context.uav}: {name} cannot be {value}.")
    since_s = context.clock()
    request = mavlink.MAVLink_param_set_message(
        *context.target, name.encode("ascii"), value, mavlink.MAV_PARAM_TYPE_REAL32
    )
    held = yield from _ask(context, name, request, value)
    if not equal(held, value):
        raise CommandError(
            507,
            f"{context.uav}: {name} is {held:g}, not {value:g}.",
            tuple(context.vehicle.texts_since(since_s)),
        )


def _ask(
    context: Context, name: str, request: Message, wanted: float | None = None
) -> Exchange[float]:
    """Value that answers the request; other values than the one wanted only after the last try."""
    held: float | None = None
    for wait_s in RETRY.waits(context.round_trip.timeout_s + READ_WAIT_S):
        until_s = context.clock() + wait_s
        yield Send(request)
        while context.clock() < until_s:
            message = yield Wait(until_s)
            if message is None or message.get_type() != "PARAM_VALUE" or message.param_id != name:
                continue
            held = message.param_value
            if wanted is None or equal(held, wanted):
                return held
    if held is not None:
        return held
    raise CommandError(
        506, f"{context.uav}: no answer for parameter {name}; does this firmware know it?"
    )


def equal(a: float, b: float) -> bool:
    """Whether two values are the same parameter value: they travel as 32-bit floats."""
    return math.isclose(float32(a), float32(b), rel_tol=1e-6, abs_tol=1e-9)
