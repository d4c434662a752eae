"""Who is who: UAV names, system ids and the links on which they are to be heard."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from jfto_mavlink.errors import RosterError
from jfto_mavlink.link.address import LinkAddress, parse_address


@dataclass(frozen=True)
class RosterEntry:
    """One vehicle. `uid` is what AUTOPILOT_VERSION must report, "" for any."""

    uav: str
    sysid: int
    link: LinkAddress
    uid: str = ""


@dataclass(frozen=True)
class Roster:
    """The fleet, in the order of the plan."""

    entries: tuple[RosterEntry, ...]

    def __post_init__(self) -> None:
        for entry in self.entries:
            if not 1 <= entry.sysid <= 250:
                raise RosterError(201, f"{entry.uav}: system id {entry.sysid} is outside 1…250.")
        for name, values in (
            ("UAV name", [entry.uav for entry in self.entries]),
            ("system id", [str(entry.sysid) for entry in self.entries]),
            ("uid", [entry.uid for entry in self.entries if entry.uid]),
        ):
            for value, count in Counter(values).items():
                if count > 1:
                    raise RosterError(
                        202,
                        f"{name} {value} stands {count} times in the roster; give each its own.",
                    )
        if not self.entries:
            raise RosterError(201, "the roster is empty; name at least one vehicle.")

    @property
    def uavs(self) -> tuple[str, ...]:
        """Names in order."""
        return tuple(entry.uav for entry in self.entries)

    @property
    def links(self) -> tuple[LinkAddress, ...]:
        """Each link once, in order of first use."""
        return tuple(dict.fromkeys(entry.link for entry in self.entries))

    def find(self, link: LinkAddress, sysid: int) -> RosterEntry | None:
        """The vehicle expected on a link under a system id."""
        for entry in self.entries:
            if entry.sysid == sysid and entry.link == link:
                return entry
        return None


def parse_roster(texts: Sequence[str]) -> Roster:
    """Read entries of the form UAV=SYSID@LINK or UAV=SYSID@LINK#UID; raises RosterError."""
    return Roster(tuple(_parse_entry(text) for text in texts))


def _parse_entry(text: str) -> RosterEntry:
    uav, equals, rest = text.partition("=")
    sysid, at, link_text = rest.partition("@")
    link, _, uid = link_text.partition("#")
    if not (uav and equals and at and sysid.isdigit()):
        raise RosterError(
            201, f'"{text}" is not UAV=SYSID@LINK, for example uav1=1@udpin:0.0.0.0:14550.'
        )
    return RosterEntry(uav, int(sysid), parse_address(link), uid.lower())
