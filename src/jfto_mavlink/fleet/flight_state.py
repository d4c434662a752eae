"""What must be known of a flight after the bridge was killed, on disk."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from jfto_mavlink.errors import FlightError
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.read_text import read_text
from jfto_msgs_py.write_file import write_file

FLIGHT_FORMAT = "jfto-flight-state"
FLIGHT_VERSION = 1
_SIZE_LIMIT = 100_000


@dataclass(frozen=True)
class FlightState:
    """A flight: missions on board (UAV to digest), time zero, and who has ended how.

    `begun_ns` is time zero in ns since the epoch on the graph's clock, None before lift-off;
    `over` is True once the flight was said to be over.
    """

    digests: Mapping[str, str]
    begun_ns: int | None = None
    ended: Mapping[str, str] = field(default_factory=dict)
    over: bool = False


def write_flight_state(book: FlightState, path: Path) -> None:
    """Write a book; raises InputError."""
    document = {
        "format": FLIGHT_FORMAT,
        "version": FLIGHT_VERSION,
        "missions": dict(book.digests),
        "lift_off_ns": book.begun_ns,
        "ended": dict(book.ended),
        "over": book.over,
    }
    write_file(path, json.dumps(document, indent=1) + "\n")


def read_flight_state(digests: Mapping[str, str], path: Path) -> FlightState | None:
    """The book of a flight of these very missions; None where there is none or it is another's.

    Raises FlightError 607 where the file is no such book.
    """
    if not path.exists():
        return None
    try:
        document = json.loads(read_text(path, InputError, "flight state", _SIZE_LIMIT))
        if (document["format"], document["version"]) != (FLIGHT_FORMAT, FLIGHT_VERSION):
            raise ValueError("other format or version")
        begun = document["lift_off_ns"]
        book = FlightState(
            {str(uav): str(digest) for uav, digest in document["missions"].items()},
            None if begun is None else int(begun),
            {str(uav): str(how) for uav, how in document["ended"].items()},
            bool(document["over"]),
        )
    except (InputError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise FlightError(
            607,
            f"{path}: does not say what flight is under way ({error!r}). It is written anew.",
        ) from None
    return book if book.digests == dict(digests) else None
