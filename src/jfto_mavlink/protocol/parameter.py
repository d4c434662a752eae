"""Parameters by name: read, and set with proof that the value was taken."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from jfto_mavlink.dialect import Message, mavlink
from jfto_mavlink.errors import CommandError
from jfto_mavlink.protocol.exchange import Context, Exchange, Send, Wait
from jfto_mavlink.protocol.item import float32
from jfto_msgs_py.retry import Retry

RETRY = Retry(ceiling_s=2.0, tries=8)
# ArduPilot answers a read after about 100 ms.
READ_WAIT_S = 0.3
# It keeps 20 reads waiting at most and drops the others without a word.
WINDOW = 10
# A name is taken for unknown once the chance that all its answers were lost is less than this; by
# the share of questions answered so far, and that is never taken for more than 98 %.
_UNHEARD, _LOSS_LEAST, _ROUNDS_MAX, _ROUNDS_DEAF = 1e-4, 0.02, 25, 8
# What ArduCopter 4.7 calls a parameter and how many times the old unit (cm) its own is: names and
# values here are those of 4.5 wherever they are not on their way.
NEWER: Mapping[str, tuple[str, float]] = {
    "WPNAV_SPEED": ("WP_SPD", 0.01),
    "WPNAV_SPEED_UP": ("WP_SPD_UP", 0.01),
    "WPNAV_SPEED_DN": ("WP_SPD_DN", 0.01),
    "WPNAV_RADIUS": ("WP_RADIUS_M", 0.01),
    "WPNAV_ACCEL": ("WP_ACC", 0.01),
    "WPNAV_ACCEL_Z": ("WP_ACC_Z", 0.01),
    "WPNAV_ACCEL_C": ("WP_ACC_CNR", 0.01),
    "WPNAV_JERK": ("WP_JERK", 1.0),
    "ANGLE_MAX": ("ATC_ANGLE_MAX", 0.01),
    "RTL_ALT": ("RTL_ALT_M", 0.01),
    "RTL_ALT_FINAL": ("RTL_ALT_FINAL_M", 0.01),
    "RTL_CLIMB_MIN": ("RTL_CLIMB_MIN_M", 0.01),
    "RTL_SPEED": ("RTL_SPEED_MS", 0.01),
    "LAND_SPEED": ("LAND_SPD_MS", 0.01),
    "LAND_SPEED_HIGH": ("LAND_SPD_HIGH_MS", 0.01),
    "LAND_ALT_LOW": ("LAND_ALT_LOW_M", 0.01),
}


def read_parameter(context: Context, name: str) -> Exchange[float]:
    """Value of a parameter. An unknown name gets no answer at all: CommandError 506."""
    spoken, unit = _spoken(context, name)
    return (yield from _ask(context, spoken, _read(context, spoken))) / unit


def read_parameters(context: Context, names: Iterable[str]) -> Exchange[dict[str, float]]:
    """Values by name of all those that the firmware knows, under an old or a newer name.

    Many reads are under way at a time. A name that is never answered is asked for again for as long
    as the link's losses may be the reason.
    """
    names = tuple(dict.fromkeys(names))
    found = yield from _read_all(context, [_spoken(context, name)[0] for name in names])
    if not context.vehicle.newer_names:
        missing = [NEWER[name][0] for name in names if name in NEWER and name not in found]
        newer = (yield from _read_all(context, missing)) if missing else {}
        if newer:
            context.vehicle.newer_names = True
            found |= newer
    spoken = {name: _spoken(context, name) for name in names}
    return {name: found[own] / unit for name, (own, unit) in spoken.items() if own in found}


def _read_all(context: Context, names: Sequence[str]) -> Exchange[dict[str, float]]:
    """Values of those of the names, as the firmware has them, that it answers."""
    found: dict[str, float] = {}
    asked_times = dict.fromkeys(names, 0)
    for round_ in range(_ROUNDS_MAX):
        missing = [name for name in names if name not in found]
        times = sum(asked_times[name] for name in found if name in asked_times)
        loss = max(1.0 - len(found) / times, _LOSS_LEAST) if times else 1.0
        if not missing or loss**round_ < _UNHEARD or (not found and round_ == _ROUNDS_DEAF):
            break
        for first in range(0, len(missing), WINDOW):
            asked = missing[first : first + WINDOW]
            for name in asked:
                asked_times[name] += 1
                yield Send(_read(context, name))
            until_s = context.clock() + context.round_trip.timeout_s + READ_WAIT_S
            while context.clock() < until_s and not found.keys() >= set(asked):
                message = yield Wait(until_s)
                if message is not None and message.get_type() == "PARAM_VALUE":
                    found[message.param_id] = message.param_value
    return found


def _spoken(context: Context, name: str) -> tuple[str, float]:
    """What the vehicle's firmware calls a parameter, and its unit in ours."""
    return NEWER.get(name, (name, 1.0)) if context.vehicle.newer_names else (name, 1.0)


def _read(context: Context, spoken: str) -> Message:
    name = spoken.encode("ascii")
    return mavlink.MAVLink_param_request_read_message(*context.target, name, -1)


def set_parameter(context: Context, name: str, value: float) -> Exchange[None]:
    """Set a parameter and see the new value come back; raises CommandError 506 or 507.

    ArduPilot checks no range, and a read-only parameter is answered with its old value.
    """
    if not math.isfinite(value):
        raise CommandError(507, f"{context.uav}: {name} cannot be {value}.")
    since_s = context.clock()
    spoken, unit = _spoken(context, name)
    wanted = value * unit
    request = mavlink.MAVLink_param_set_message(
        *context.target, spoken.encode("ascii"), wanted, mavlink.MAV_PARAM_TYPE_REAL32
    )
    held = yield from _ask(context, spoken, request, wanted)
    if not equal(held, wanted):
        raise CommandError(
            507,
            f"{context.uav}: {spoken} is {held:g}, not {wanted:g}.",
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
