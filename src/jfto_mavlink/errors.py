"""What can go wrong between the station and the vehicles, each with a number of its own.

The numbers are part of the interface: scripts and logs may rely on them, so none is ever reused.
100 links, 200 roster, 300 missions and files, 400 mission transfer, 500 commands,
600 before and during flight, 700 signing.
"""

from __future__ import annotations

from jfto_msgs_py.errors import InputError, JftoError

CODES: dict[int, str] = {
    101: "link address cannot be read",
    102: "link cannot be opened",
    103: "link lost",
    201: "roster entry cannot be read",
    202: "two vehicles share an id",
    203: "vehicle is not the one the roster names",
    204: "two vehicles answer to one system id",
    205: "vehicle is not heard",
    301: "mission breaks a limit",
    302: "mission file cannot be read",
    303: "plan and fleet do not fit together",
    304: "terrain heights are not served",
    401: "vehicle refused the mission",
    402: "another station holds the vehicle's mission",
    403: "vehicle stopped answering during a transfer",
    404: "mission on board differs from the mission sent",
    405: "mission may not be changed now",
    406: "fleet not released",
    501: "command got no answer",
    502: "command denied",
    503: "command failed",
    504: "command not supported",
    505: "command accepted but without effect",
    506: "parameter got no answer",
    507: "parameter not taken",
    601: "vehicle is not ready",
    602: "mission on board is not the released one",
    603: "flight ended before its last waypoint",
    604: "waypoint missed",
    605: "another order is being carried out",
    606: "arming is not allowed",
    607: "state of the flight cannot be read",
    701: "key file cannot be used",
    702: "vehicle does not accept the key",
}


class MavlinkError(JftoError):
    """Base of the bridge's errors. `code` is one of CODES; the text carries it as [MAV-code]."""

    def __init__(self, code: int, message: str) -> None:
        super().__init__(f"{message} [MAV-{code}]")
        self.code = code


class LinkError(MavlinkError):
    """A link cannot be opened, read or written."""


class LinkAddressError(LinkError, InputError):
    """The text that names a link is wrong."""

    exit_status = 2


class RosterError(MavlinkError, InputError):
    """The roster contradicts itself or the vehicles that answer."""

    exit_status = 2


class MissionError(MavlinkError, InputError):
    """A mission cannot be built, or breaks a limit that the autopilot would not check."""

    exit_status = 2


class MissionFileError(MavlinkError, InputError):
    """A mission file cannot be read."""

    exit_status = 2


class TransferError(MavlinkError):
    """A mission could not be written to or read from a vehicle; `state` says what it now holds."""

    def __init__(self, code: int, message: str, state: str = "") -> None:
        super().__init__(code, f"{message} {state}".strip())
        self.state = state


class CommandError(MavlinkError):
    """A command or parameter was refused, failed or got no answer; `reasons` are its own words."""

    def __init__(self, code: int, message: str, reasons: tuple[str, ...] = ()) -> None:
        super().__init__(code, " ".join([message, *(f'"{reason}"' for reason in reasons)]))
        self.reasons = reasons


class FlightError(MavlinkError):
    """A vehicle may not fly, or did not fly what it was told to."""


class SigningError(MavlinkError):
    """A signing key is unusable or not accepted."""
