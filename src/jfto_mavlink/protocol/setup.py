"""What a vehicle is asked for when it is first heard, and the signing key that it is given.

Nothing but heartbeats comes by itself, each port has its own settings, and a restart forgets them.
"""

from __future__ import annotations

from collections.abc import Mapping

from jfto_mavlink.dialect import Message, mavlink
from jfto_mavlink.errors import CommandError, SigningError
from jfto_mavlink.io.framing import Frame
from jfto_mavlink.io.signing import Signer
from jfto_mavlink.protocol.command import request_message, send_command
from jfto_mavlink.protocol.exchange import Context, Exchange, Report, Send, Wait
from jfto_mavlink.protocol.vehicle_state import VehicleState
from jfto_msgs_py.retry import Retry

# Message id -> rate in Hz.
DEFAULT_RATES: Mapping[int, float] = {
    mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: 10.0,
    mavlink.MAVLINK_MSG_ID_ATTITUDE: 10.0,
    mavlink.MAVLINK_MSG_ID_SYS_STATUS: 2.0,
    mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: 2.0,
    mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT: 2.0,
    mavlink.MAVLINK_MSG_ID_MISSION_CURRENT: 2.0,
    mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: 2.0,
    mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: 1.0,
}
# Patient with a busy link, impatient enough that a reboot in the middle is noticed.
_RETRY = Retry(ceiling_s=1.5, tries=6)
# A stream is taken for missing after this many of its periods, and this time at least.
_MISSING_PERIODS = 4.0
_MISSING_S = 3.0


def rates_for(telemetry_rate_hz: float, speedup: float) -> dict[int, float]:
    """Message rates, Hz: position and attitude as asked for, the fix at most as often.

    From vehicles whose time passes faster all but the position comes once a second of theirs.
    """
    position = {mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: telemetry_rate_hz}
    if speedup > 1.0:
        return {message_id: min(rate, 1.0) for message_id, rate in DEFAULT_RATES.items()} | position
    return {
        **DEFAULT_RATES,
        **position,
        mavlink.MAVLINK_MSG_ID_ATTITUDE: telemetry_rate_hz,
        mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: min(telemetry_rate_hz, 5.0),
    }


def missing_streams(
    vehicle: VehicleState, rates: Mapping[int, float], since_s: float, now_s: float
) -> dict[int, float]:
    """Streams wanted that have not been heard lately; `since_s` is when they were asked for."""
    return {
        message_id: rate_hz
        for message_id, rate_hz in rates.items()
        if now_s - max(vehicle.seen_s.get(message_id, since_s), since_s)
        > max(_MISSING_S, _MISSING_PERIODS / rate_hz)
    }


def greet(context: Context, rates: Mapping[int, float]) -> Exchange[None]:
    """Ask who the vehicle is and for its streams; what it refuses is reported and left out."""
    if context.vehicle.uid is None:
        yield from _ask(context, mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
    if context.vehicle.home_deg_m is None:
        # Not known before the first position fix; it comes by itself then.
        yield from _ask(context, mavlink.MAVLINK_MSG_ID_HOME_POSITION)
    for message_id, rate_hz in rates.items():
        try:
            yield from send_command(
                context,
                mavlink.MAV_CMD_SET_MESSAGE_INTERVAL,
                (float(message_id), 1e6 / rate_hz),
                retry=_RETRY,
            )
        except CommandError as error:
            yield Report(str(error))


def ask_version(context: Context) -> Message:
    """The question who a vehicle is, which AUTOPILOT_VERSION answers."""
    version = mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION
    return mavlink.MAVLink_command_long_message(
        *context.target, mavlink.MAV_CMD_REQUEST_MESSAGE, 0, version, *([0] * 6)
    )


def _ask(context: Context, message_id: int) -> Exchange[None]:
    try:
        yield from request_message(context, message_id)
    except CommandError as error:
        yield Report(str(error))


# Heartbeats come every second; the first signed one is the proof.
PROOF = Retry(first_s=2.5, ceiling_s=2.5, tries=6)


def setup_signing(context: Context, signer: Signer) -> Exchange[None]:
    """Send the key until the vehicle's own frames carry a good signature.

    SETUP_SIGNING is never acknowledged, and refused while armed. The key travels in the clear: use
    a cable. Raises SigningError 702. The key is in no report and in no log of texts.
    """
    if context.vehicle.armed:
        raise SigningError(702, f"{context.uav}: is armed; keys are only taken on the ground.")
    since_s = context.clock()
    for wait_s in PROOF.waits():
        yield Send(
            mavlink.MAVLink_setup_signing_message(
                *context.target, list(signer.key), signer.next_stamp()
            )
        )
        until_s = context.clock() + wait_s
        while context.clock() < until_s:
            message = yield Wait(until_s)
            if message is None:
                continue
            frame = Frame(bytes(message.get_msgbuf()), message)
            if frame.signed and signer.accepts(frame):
                yield Report("signs with the new key")
                return
    texts = " ".join(f'"{text}"' for text in context.vehicle.texts_since(since_s))
    raise SigningError(702, f"{context.uav}: does not sign with the new key. {texts}".strip())
