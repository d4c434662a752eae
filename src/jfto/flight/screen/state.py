"""What the screen of a flight shows, at one moment."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.records.event import Event

# What a UAV does, in the words that the operator reads.
UNHEARD, UNPLACED, PAD, FLYING, HOLDING, HOME, LANDED, SILENT = (
    "not heard",
    "no position yet",
    "on pad",
    "flying",
    "holding",
    "going home",
    "landed",
    "silent",
)


@dataclass(frozen=True)
class LinkState:
    """A radio neighbour and what the link could lose, dB; below 0 the link is broken."""

    peer: str
    spare_db: float


@dataclass(frozen=True)
class UavState:
    """One UAV. None stands for what is not known (yet).

    `index` is its place in the fleet, which decides its colour and mark; `phase` one of the words
    above; `done` of `total` waypoints are behind it, the next is due in `next_in_s`; `late_s` is
    positive behind the plan; `age_s` how old the last pose is.
    """

    id: str
    index: int
    phase: str
    done: int = 0
    total: int = 0
    next_in_s: float | None = None
    late_s: float | None = None
    energy_left_j: float | None = None
    energy_budget_j: float | None = None
    battery_percent: float | None = None
    tx_dbm: float | None = None
    links: tuple[LinkState, ...] = ()
    age_s: float | None = None

    @property
    def neighbours(self) -> int:
        """Links that hold."""
        return sum(link.spare_db >= 0 for link in self.links)

    @property
    def energy_share(self) -> float | None:
        """Energy left for transmitting, 0 to 1."""
        if self.energy_left_j is None or not self.energy_budget_j:
            return None
        return max(self.energy_left_j / self.energy_budget_j, 0.0)


@dataclass(frozen=True)
class FlightState:
    """The whole screen.

    `doing` says in a word or two what the fleet is at; `clock_s` counts from lift-off, None before
    it; `slot` of `slot_count` is under way, -1 before the first. `parts` is the number of pieces
    that the links leave the fleet in, 0 where nobody has a link. `lift_off_ns` is time zero on the
    clock of the events, None before it.
    """

    title: str
    doing: str
    clock_s: float | None
    horizon_s: float
    slot: int
    slot_count: int
    k_min: int
    parts: int
    uavs: tuple[UavState, ...]
    events: tuple[Event, ...] = ()
    lift_off_ns: int | None = None

    @property
    def weakest(self) -> tuple[str, str, float] | None:
        """The link with the least to spare of those that hold, None without any."""
        holding = [link for link in self._links if link[2] >= 0]
        return min(holding, key=lambda link: link[2], default=None)

    @property
    def broken(self) -> tuple[tuple[str, str, float], ...]:
        """Links of the topology that do not hold, each once, the worst first."""
        found: dict[frozenset[str], tuple[str, str, float]] = {}
        for link in self._links:
            if link[2] < 0:
                found.setdefault(frozenset(link[:2]), link)
        return tuple(sorted(found.values(), key=lambda link: link[2]))

    @property
    def _links(self) -> list[tuple[str, str, float]]:
        return [(uav.id, link.peer, link.spare_db) for uav in self.uavs for link in uav.links]

    @property
    def done(self) -> int:
        """Waypoints behind the fleet."""
        return sum(uav.done for uav in self.uavs)

    @property
    def total(self) -> int:
        """Waypoints of the fleet."""
        return sum(uav.total for uav in self.uavs)
