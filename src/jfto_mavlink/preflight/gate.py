"""The gate before a vehicle is written to or armed: it is asked, waited for and read back."""

from __future__ import annotations

from dataclasses import replace

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import CommandError, TransferError
from jfto_mavlink.mission.build import VehicleMission
from jfto_mavlink.mission.deliver import verify
from jfto_mavlink.preflight.facts import Aboard, Surveyed, snapshot, survey
from jfto_mavlink.preflight.ready import unready
from jfto_mavlink.preflight.settings import GateSettings
from jfto_mavlink.protocol.command import send_command
from jfto_mavlink.protocol.exchange import Context, Exchange, Report, Wait, wait_for
from jfto_mavlink.protocol.item import Mission
from jfto_msgs_py.retry import Retry

CHECKS_EVERY_S = 5.0


def inspect(
    context: Context,
    mission: VehicleMission,
    settings: GateSettings,
    *,
    wait: bool = True,
    released: Mission | None = None,
) -> Exchange[Surveyed]:
    """Find out everything that the checks of one vehicle go by.

    With `wait` it may take `settings.wait_s` to become ready to arm. What it then holds is compared
    with the mission `released`, if one is given; parameters are not, they are set at the start.
    """
    if not (yield from _heard(context, settings.wait_s if wait else 0.0)):
        # Nobody is there to be asked.
        return Surveyed(snapshot(context.vehicle, context.clock()), Aboard(unread="not heard"))
    names = tuple(name for name, _ in mission.mission.parameters)
    aboard = yield from survey(context, names)
    if wait:
        yield from wait_ready(context, settings)
    now = snapshot(context.vehicle, context.clock())
    if released is not None and not any(unready(now, settings)):
        try:
            differing = yield from verify(context, released)
        except TransferError as error:
            differing = (str(error),)
        aboard = replace(aboard, differing=differing)
    return Surveyed(now, aboard)


def _heard(context: Context, wait_s: float) -> Exchange[bool]:
    """Whether the vehicle has been heard at all; waits for it, and says so."""

    def heard() -> bool:
        return context.vehicle.heartbeat_s is not None

    if not heard() and wait_s:
        yield Report(f"not heard yet: it is waited for, {wait_s:g} s at most")
    return (yield from wait_for(context, heard, wait_s))


def wait_ready(context: Context, settings: GateSettings) -> Exchange[None]:
    """Wait until nothing speaks against arming, at most `settings.wait_s`; say what does."""
    until_s = context.clock() + settings.wait_s
    ask_s = context.clock()
    told: tuple[str, ...] = ()
    while found := tuple(unready(snapshot(context.vehicle, context.clock()), settings)):
        now_s = context.clock()
        if now_s >= until_s:
            return
        if now_s >= ask_s:
            ask_s = now_s + CHECKS_EVERY_S
            texts = tuple(finding.text for finding in found)
            if texts != told:
                yield Report(f"not ready: {'; '.join(texts)}")
            told = texts
            yield from _ask_for_checks(context)
        yield Wait(min(until_s, ask_s))


def _ask_for_checks(context: Context) -> Exchange[None]:
    """Let the autopilot say what it misses; its texts follow by themselves."""
    try:
        yield from send_command(context, mavlink.MAV_CMD_RUN_PREARM_CHECKS, retry=Retry(tries=2))
    except CommandError as error:
        # Refused while armed, which is reported anyway.
        yield Report(str(error))
