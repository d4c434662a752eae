"""How fast simulated vehicles' time may pass, so that nobody in their graph falls behind.

It knows no ROS and no clock of its own.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

NS = 1_000_000_000


@dataclass(frozen=True)
class PaceSettings:
    """Seconds of the vehicles' time that they may be ahead of their graph, and what is done then.

    Time stands while somebody is waited for. In the second half of `patience_s`, of this computer's
    time, it creeps, so that a report that was lost is followed by another. Whoever has not come on
    by then is waited for no more; until it comes on, or is gone, the vehicles keep to real time.
    """

    ahead_s: float = 0.6
    creep: float = 0.1
    patience_s: float = 10.0


@dataclass
class _Follower:
    """Somebody in the graph: how far it has come, and since when it is waited for, if it is."""

    at_ns: int
    since_s: float | None = None

    def come_to(self, at_ns: int) -> None:
        if at_ns != self.at_ns:
            self.at_ns, self.since_s = at_ns, None


@dataclass(frozen=True)
class PacedFlight:
    """A flight that is over: its seconds on the vehicles' clock and on this computer's.

    `waited_s` says how long each node, or pose of a UAV, was waited for.
    """

    fleet_s: float
    wall_s: float
    waited_s: Mapping[str, float]

    @property
    def speed(self) -> float:
        """How much faster than this computer's the vehicles' time passed."""
        return self.fleet_s / max(self.wall_s, 1e-3)


class FleetPace:
    """Grants vehicles their time, by what the graph's nodes and their own poses tell of theirs.

    Nodes are to follow the clock, poses the positions that their UAVs have sent. A node that never
    reported is not waited for, nor the pose of a UAV that sends nothing. `given_up` names those who
    are waited for no more.
    """

    def __init__(self, settings: PaceSettings | None = None) -> None:
        self._settings = settings or PaceSettings()
        self._nodes: dict[str, _Follower] = {}
        self._poses: dict[str, _Follower] = {}
        # UAVs whose poses come from somebody new, and since when in this computer's time.
        self._linking: dict[str, float | None] = {}
        self._waited_s: dict[str, float] = {}
        # Vehicles' and computer's time when the flight began that is on.
        self._begun: tuple[int, float] | None = None
        self.given_up: frozenset[str] = frozenset()

    @property
    def flying(self) -> bool:
        """Whether a flight is on."""
        return self._begun is not None

    def node_at(self, name: str, at_ns: int) -> None:
        """A node has come so far, ns since the epoch."""
        self._nodes.setdefault(name, _Follower(at_ns)).come_to(at_ns)

    def pose_at(self, uav: str, at_ns: int) -> None:
        """The newest pose of a UAV was measured then, ns since the epoch."""
        self._poses.setdefault(uav, _Follower(at_ns)).come_to(at_ns)
        self._linking.pop(uav, None)

    def forget(self, name: str) -> None:
        """A node is gone: nobody waits for it."""
        self._nodes.pop(name, None)

    def pose_source(self, uav: str) -> None:
        """Who publishes this UAV's poses has come anew: positions sent to its predecessor are lost.

        It takes its time to link: until its first pose the vehicles keep to real time.
        """
        if self._poses.pop(uav, None) is not None:
            self._linking[uav] = None

    def grant(
        self, now_ns: int, sent_ns: Mapping[str, int], wall_s: float, passed_s: float
    ) -> float:
        """Seconds by which the vehicles' time may go on; infinite: as they like.

        `now_ns` is their time and `sent_ns` that of the newest position that each UAV has sent;
        `wall_s` is this computer's, of which `passed_s` have passed since the last call.
        """
        # Copies: reports come in another thread.
        behind_ns = [(name, one, now_ns - one.at_ns) for name, one in tuple(self._nodes.items())]
        behind_ns += [
            (_pose_of(uav), one, max(sent_ns.get(uav, 0) - one.at_ns, 0))
            for uav, one in tuple(self._poses.items())
        ]
        patience_s = self._settings.patience_s
        given_up, least_s, speed = set(), math.inf, self._linking_speed(wall_s)
        for name, one, late_ns in behind_ns:
            room_s = self._settings.ahead_s - late_ns / NS
            if room_s > 0:
                one.since_s, least_s = None, min(least_s, room_s)
                continue
            one.since_s = wall_s if one.since_s is None else one.since_s
            if wall_s - one.since_s > patience_s:
                given_up.add(name)
                speed = min(speed, 1.0)
            else:
                self._waited_s[name] = self._waited_s.get(name, 0.0) + passed_s
                creeps = wall_s - one.since_s > patience_s / 2
                speed = min(speed, self._settings.creep if creeps else 0.0)
        self.given_up = frozenset(given_up)
        return least_s if math.isinf(speed) else min(least_s, speed * passed_s)

    def _linking_speed(self, wall_s: float) -> float:
        """Real time while poses of somebody new are due."""
        for uav, since_s in tuple(self._linking.items()):
            self._linking[uav] = wall_s if since_s is None else since_s
            if wall_s - (since_s or wall_s) > self._settings.patience_s:
                self._linking.pop(uav, None)
        return 1.0 if self._linking else math.inf

    def look(self, now_ns: int, wall_s: float, *, flying: bool) -> PacedFlight | None:
        """Take note of whether somebody flies; returns the flight that has just ended, if any."""
        begun = self._begun
        if flying == (begun is not None):
            return None
        waited_s, self._waited_s = self._waited_s, {}
        if begun is None:
            self._begun = (now_ns, wall_s)
            return None
        self._begun = None
        return PacedFlight((now_ns - begun[0]) / NS, wall_s - begun[1], waited_s)


def _pose_of(uav: str) -> str:
    return f"{uav}'s poses"
