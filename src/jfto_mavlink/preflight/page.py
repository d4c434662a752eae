"""What came of the checks: findings by vehicle and topic, each with its cure; also as a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from jfto_msgs_py.files import FileKind, read_record, write_record
from jfto_msgs_py.records.fields import OneOf

GREEN, AMBER, RED = "green", "amber", "red"
LEVELS = (GREEN, AMBER, RED)
# In the order in which they are shown, with what each is about.
TOPICS = {
    "identity": "who answers on the link",
    "pad": "where it stands",
    "position": "GPS and position estimate",
    "autopilot": "the autopilot's own checks",
    "clock": "its clock against ours",
    "mission": "what is on board against the plan",
    "fence": "the mission against the vehicle's fence",
    "speed": "speeds flown against the vehicle's own",
    "home": "height and time of the way home",
    "battery": "charge against the time needed",
    "wind": "wind against what the plan allows for",
    "failsafe": "what it does by itself",
    "parameters": "what is changed for the flight",
}
# Colour never says it alone.
SIGNS = {GREEN: "✓ fine", AMBER: "! look", RED: "✗ stop"}
WAITS = "… wait"
VERDICTS = {
    GREEN: "Preflight: all fine.",
    AMBER: "Preflight: nothing speaks against a start; look at what is marked !.",
    RED: "Preflight: not to be flown like this; see what is marked ✗.",
}
# What time on the pad may cure keeps nobody from uploading.
LATER = frozenset(("position", "autopilot", "clock", "mission"))
_FILE = FileKind(
    "preflight page", "Run the checks again.", format="jfto-preflight", size_limit=5_000_000
)


@dataclass(frozen=True)
class Finding:
    """One result: `topic` of TOPICS, `level` GREEN, AMBER or RED; `cure` may be "".

    `waits` marks what is not ready yet and passes by itself: whoever starts waits for it.
    """

    topic: Annotated[str, OneOf(tuple(TOPICS))]
    level: Annotated[str, OneOf(LEVELS)]
    text: str
    cure: str = ""
    waits: bool = False

    def __str__(self) -> str:
        return f"{self.text}. {self.cure}".strip() if self.cure else self.text

    @property
    def sign(self) -> str:
        """A mark and a word for the level."""
        return WAITS if self.waits else SIGNS[self.level]


@dataclass(frozen=True)
class Change:
    """A parameter that is set for the flight, in the units of ArduCopter 4.5."""

    name: str
    old: float
    new: float

    def __str__(self) -> str:
        return f"{self.name} {self.old:g} → {self.new:g}"


@dataclass(frozen=True)
class VehiclePage:
    """Everything found of one vehicle, in the order of TOPICS."""

    uav: str
    findings: tuple[Finding, ...]
    changes: tuple[Change, ...] = ()

    def of(self, topic: str) -> tuple[Finding, ...]:
        """Findings of a topic."""
        return tuple(each for each in self.findings if each.topic == topic)

    @property
    def level(self) -> str:
        """The worst."""
        return worst(self.findings)


@dataclass(frozen=True)
class Preflight:
    """The page of a fleet."""

    vehicles: tuple[VehiclePage, ...]

    @property
    def level(self) -> str:
        """The worst of all."""
        return worst([each for vehicle in self.vehicles for each in vehicle.findings])

    @property
    def verdict(self) -> str:
        """What it comes to, in a sentence."""
        return VERDICTS[self.level]

    def rows(self) -> list[tuple[Finding, tuple[str, ...]]]:
        """Each finding with the vehicles that have it ("all"), the worst first, else as TOPICS."""
        who: dict[Finding, list[str]] = {}
        for vehicle in self.vehicles:
            for finding in vehicle.findings:
                who.setdefault(finding, []).append(vehicle.uav)
        everybody = [vehicle.uav for vehicle in self.vehicles]
        order = list(TOPICS)
        found = sorted(who, key=lambda f: (-LEVELS.index(f.level), order.index(f.topic)))
        shared = len(everybody) > 1
        return [(f, ("all",) if shared and who[f] == everybody else tuple(who[f])) for f in found]

    def counts(self) -> dict[str, int]:
        """How many findings there are of each level, and how many of them are waited for."""
        found = [each for vehicle in self.vehicles for each in vehicle.findings]
        levels = {level: sum(each.level == level for each in found) for level in LEVELS}
        return levels | {"waits": sum(each.waits for each in found)}

    def stops(self, *, uploading: bool = False) -> tuple[str, ...]:
        """What speaks against arming, or already against `uploading`: a line each."""
        return tuple(
            f"{vehicle.uav}: {finding}"
            for vehicle in self.vehicles
            for finding in vehicle.findings
            if finding.level == RED and not (uploading and finding.topic in LATER)
        )


def worst(findings: tuple[Finding, ...] | list[Finding]) -> str:
    """The worst level of findings, GREEN of none."""
    return max((each.level for each in findings), key=LEVELS.index, default=GREEN)


def write_page(page: Preflight, path: Path) -> None:
    """Write the page as JSON; raises InputError."""
    write_record(page, path, _FILE)


def read_page(path: Path) -> Preflight:
    """The page in a file; raises InputError."""
    return read_record(path, Preflight, _FILE)
