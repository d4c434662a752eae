"""Giving a vehicle its signing key, with proof that it uses it."""

from __future__ import annotations

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import SigningError
from jfto_mavlink.exchange import Context, Exchange, Report, Send, Wait
from jfto_mavlink.link.framing import Frame
from jfto_mavlink.link.signing import Signer

TRIES = 6
# Heartbeats come every second; the first signed one is the proof.
PROOF_WAIT_S = 2.5


def setup_signing(context: Context, signer: Signer) -> Exchange[None]:
    """Send the key until the vehicle's own frames carry a good signature.

    SETUP_SIGNING is never acknowledged, and refused while armed. The key travels in the clear: use
    a cable. Raises SigningError 702. The key is in no report and in no log of texts.
    """
    if context.vehicle.armed:
        raise SigningError(702, f"{context.uav}: is armed; keys are only taken on the ground.")
    since_s = context.clock()
    for _ in range(TRIES):
        yield Send(
            mavlink.MAVLink_setup_signing_message(
                *context.target, list(signer.key), signer.next_stamp()
            )
        )
        until_s = context.clock() + PROOF_WAIT_S
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
