"""Tells of breaches of the certificate before they happen, once each, and when they are over."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.core import Episodes
from jfto_msgs_py.records.event import ERROR, INFO, WARN, Event
from jfto_topology.algorithms.ctop import ctop
from jfto_topology.horizon import HorizonTopology
from jfto_topology.links import Links
from jfto_topology.look_ahead import Danger, Rules, energy_danger, look_ahead
from jfto_world.motion.fleet_prediction import FleetPrediction

Key = tuple[str, str]

# Between two slots the fleet is looked at so often.
FINER = 10
# A danger that flickers with the noise of the poses is one danger.
_CLEAR_AFTER = 3
# Nearer to its pad than this a UAV stands, takes off or lands.
_HOME_M = 15.0
_HOME_HEIGHT_M = 5.0


class FlightWatch:
    """Evaluates the rules on where the fleet will be, `slots_ahead` slots ahead.

    `dangers` holds the text of each that is on.
    """

    def __init__(
        self, prediction: FleetPrediction, links: Links, d_min_m: float, slots_ahead: int
    ) -> None:
        self._prediction = prediction
        self._links = links
        self._d_min_m = d_min_m
        self._slots_ahead = slots_ahead
        self._episodes: Episodes[Key] = Episodes(_CLEAR_AFTER)
        # When it came to each danger that is on; None while it is ahead.
        self._came_ns: dict[Key, int | None] = {}
        self.dangers: dict[Key, str] = {}

    def look(
        self, solved: HorizonTopology, slot_count: int, now_ns: int, left_j: dict[str, float]
    ) -> list[Event]:
        """What is to be told after a slot was solved; `left_j` is the energy left where known."""
        horizon, uav_ids = solved.adjacency.horizon, solved.adjacency.uav_ids
        slot_s = horizon.duration_s
        here = horizon.first + (now_ns - horizon.t0_ns) / 1e9 / slot_s
        ahead = min(float(self._slots_ahead), max(slot_count - here, 0.0))
        steps = np.arange(int(ahead * FINER) + 1) / FINER
        instants_ns = now_ns + np.rint(steps * slot_s * 1e9).astype(np.int64)
        positions_m = self._prediction.positions(uav_ids, instants_ns, stay=True)
        dangers = look_ahead(positions_m, self._rules(solved), self._apart(uav_ids))
        texts: dict[Key, tuple[float, str]] = {}
        for danger in dangers:
            lead_s = float(steps[danger.first] * slot_s)
            slot = max(here, 0.0) + steps[danger.first]
            key, text = self._text(danger, uav_ids, lead_s, slot, solved.k_min)
            texts[key] = (lead_s, text)
        texts.update(self._energy(solved, slot_count, left_j))
        return self._events(texts, now_ns)

    def _rules(self, solved: HorizonTopology) -> Rules:
        p_max_w = np.array([self._links.p_max_w[uav] for uav in solved.adjacency.uav_ids])
        return Rules(
            self._links.channel, p_max_w, self._links.sensitivity_w, solved.k_min, self._d_min_m
        )

    def _apart(self, uav_ids: tuple[str, ...]) -> NDArray[np.bool_]:
        """Pairs that are to be apart: not two that stand on their pads."""
        home = np.zeros(len(uav_ids), dtype=np.bool_)
        for index, uav in enumerate(uav_ids):
            away_m = self._prediction.from_start_m(uav)
            home[index] = bool(
                np.hypot(away_m[0], away_m[1]) < _HOME_M and abs(away_m[2]) < _HOME_HEIGHT_M
            )
        return ~(home[:, None] & home[None, :])

    def _text(
        self, danger: Danger, uav_ids: tuple[str, ...], lead_s: float, slot: float, k_min: int
    ) -> tuple[Key, str]:
        names = [uav_ids[uav] for uav in danger.uavs]
        when = f"in {lead_s:.0f} s (slot {slot:.1f})" if lead_s > 0 else f"now (slot {slot:.1f})"
        lack = -danger.margin
        text = {
            "k_min": f"{''.join(names)} has no {k_min}. neighbour at full power {when}, up to "
            f"{lack:.1f} dB short; the topology keeps what links there are.",
            "d_min": f"{' and '.join(names)} are closer than {self._d_min_m:g} m {when}, down to "
            f"{self._d_min_m + danger.margin:.1f} m; no order was given.",
            "connectivity": f"The fleet is in parts {when}, up to {lack:.1f} dB short of each "
            "other; the topology keeps what links there are.",
        }[danger.kind]
        return (danger.kind, "+".join(names)), text

    def _energy(
        self, solved: HorizonTopology, slot_count: int, left_j: dict[str, float]
    ) -> dict[Key, tuple[float, str]]:
        """UAVs that cannot pay for the rest of the mission, all its slots and not the horizon's."""
        horizon, uav_ids = solved.adjacency.horizon, solved.adjacency.uav_ids
        if not left_j or horizon.first >= slot_count:
            return {}
        count = slot_count + 1 - horizon.first
        step_ns = np.rint(np.arange(count) * horizon.duration_s * 1e9).astype(np.int64)
        topology = ctop(
            self._prediction.positions(uav_ids, horizon.t0_ns + step_ns),
            self._links.channel,
            self._rules(solved).p_max_w,
            self._links.sensitivity_w,
            solved.k_min,
            self._links.delta,
        )
        left = np.array([left_j.get(uav, np.inf) for uav in uav_ids])
        texts = {}
        for danger in energy_danger(topology.p_min_w, horizon.duration_s, left):
            uav = uav_ids[danger.uavs[0]]
            text = (
                f"{uav}'s radio cannot pay for its least powers from slot "
                f"{horizon.first + danger.first} on: {-danger.margin:.2g} J short; it is held as "
                "long as its energy lasts."
            )
            texts["energy", uav] = (danger.first * horizon.duration_s, text)
        return texts

    def _events(self, texts: dict[Key, tuple[float, str]], now_ns: int) -> list[Event]:
        began, over = self._episodes.update(texts)
        events: list[Event] = []
        for key, (lead_s, text) in texts.items():
            self.dangers[key] = text
            if key in began:
                self._came_ns[key] = None
                events.append(Event(WARN if lead_s > 0 else ERROR, *key, text))
            if lead_s <= 0 and self._came_ns[key] is None:
                self._came_ns[key] = now_ns
        for key in over:
            came_ns = self._came_ns.pop(key)
            del self.dangers[key]
            end = "it did not come to it"
            if came_ns is not None:
                end = f"it was so for {(now_ns - came_ns) / 1e9:.0f} s"
            events.append(Event(INFO, *key, f"{_OVER[key[0]].format(key[1])}; {end}."))
        return events


_OVER = {
    "k_min": "{} has, and keeps, neighbours enough",
    "d_min": "{} are, and stay, apart",
    "connectivity": "The fleet is, and stays, in one piece{}",
    "energy": "{}'s energy lasts for its least powers again",
}
