"""Follows a fleet's flight: when it began, what befalls whom, how each vehicle ends, when all have.

Fed with the states that vehicles report; knows no ROS and no thread.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from jfto_mavlink.fleet.changes import LEAVING, place_text, state_changes, troubles_in_flight
from jfto_mavlink.flight.follow import Moment
from jfto_mavlink.flight.telemetry import LOST_AFTER_S, LinkState
from jfto_mavlink.mission.build import VehicleMission
from jfto_mavlink.protocol.item import distance_m
from jfto_msgs_py.records.event import ERROR, INFO, WARN, Event

# Vehicles of a fleet start together; after this long the ones that have not are not waited for.
TOGETHER_S = 6.0
# Nobody waits longer for a lost vehicle once all others have ended their flights.
GIVE_UP_S = 60.0
ON_PAD_M = 5.0
HOME = "landed on its pad"


@dataclass(frozen=True)
class FlightState:
    """What must be known of a flight after the program that watched it was killed.

    `missions` are those on board (UAV to digest), `lift_off_ns` is time zero in ns since the epoch
    on the graph's clock, None before lift-off; `ended` says of a UAV how it ended its flight;
    `over` is True once the flight was said to be over.
    """

    missions: Mapping[str, str]
    lift_off_ns: int | None = None
    ended: Mapping[str, str] = field(default_factory=dict)
    over: bool = False


@dataclass
class _Craft:
    """One vehicle in the flight. `ended` says how, "" while it has not."""

    state: LinkState
    flying: bool = False
    silent: bool = False
    done: bool = False
    left: bool = False
    ended: str = ""


class FlightMonitor:
    """`take` returns what is to be told, stamped with the clock of the states (ns).

    `lifted` says whether the flight has begun, `begun` when, None where an earlier run of the
    program knew it. `past` is what that run has kept of a flight that it began.
    """

    def __init__(
        self,
        missions: Mapping[str, VehicleMission],
        past: FlightState | None = None,
        lost_after_s: float = LOST_AFTER_S,
    ) -> None:
        under_way = past is not None and past.lift_off_ns is not None
        ended = dict(past.ended) if past is not None and under_way else {}
        self._missions = dict(missions)
        self._lost_after_s = lost_after_s
        self.lifted, self._since_s = under_way, math.inf
        self.begun: Moment | None = None
        self.over = False
        self._crafts = {
            uav: _Craft(
                LinkState(uav, -math.inf),
                flying=under_way and uav not in ended,
                ended=ended.get(uav, ""),
                left=uav in ended,
            )
            for uav in missions
        }

    @property
    def ended(self) -> dict[str, str]:
        """How each UAV that has ended its flight did so."""
        return {uav: craft.ended for uav, craft in self._crafts.items() if craft.ended}

    @property
    def flying(self) -> list[str]:
        """Who flies and is heard."""
        return [u for u, craft in self._crafts.items() if craft.flying and not craft.silent]

    def state(self, uav: str) -> LinkState:
        """A vehicle's last state."""
        return self._crafts[uav].state

    def unvisited(self, uav: str) -> tuple[int, ...]:
        """Ids of the waypoints of a UAV's route that it has not passed, in order."""
        return self._missions[uav].waypoint_ids[self._crafts[uav].state.reached :]

    def take(self, state: LinkState) -> list[Event]:
        """Compare a vehicle's state with its last one; returns what is to be told, oldest first.

        Changes of plain state are at DEBUG, what an operator must learn of is above that.
        """
        craft = self._crafts[state.uav]
        before, craft.state = craft.state, state
        self._since_s = min(self._since_s, state.at_s)
        found = state_changes(before, state)
        self._off_the_ground(craft, state)
        found += self._heard(craft, state)
        if craft.flying and not craft.silent and _known(before):
            if not state.armed:
                found += self._landed(craft, state)
            else:
                found += self._told(craft, troubles_in_flight(before, state))
                found += self._done(craft, state)
        found += [*self._begun(state.at_s), *self._over()]
        return [replace(event, stamp_ns=round(state.at_s * 1e9)) for event in found]

    def _off_the_ground(self, craft: _Craft, state: LinkState) -> None:
        if craft.flying or not state.in_flight:
            return
        if self.over:
            # The next flight.
            self.over, self.lifted, self.begun = False, False, None
            for other in self._crafts.values():
                other.ended, other.left, other.done = "", False, False
        craft.flying, craft.ended, craft.left, craft.done = True, "", False, False

    def _heard(self, craft: _Craft, state: LinkState) -> list[Event]:
        uav, silent_s = state.uav, min(state.silent_s, state.at_s - self._since_s)
        silent = silent_s > self._lost_after_s
        never = math.isinf(state.silent_s)
        if silent == craft.silent or (never and not craft.flying):
            return []
        craft.silent = silent
        if not craft.flying:
            words = f"not heard for {silent_s:.0f} s" if silent else "heard again"
            return [
                Event(WARN if silent else INFO, "link", uav, f"{uav} on the ground is {words}.")
            ]
        if not silent:
            # Back from the dead, the flight goes on.
            self.over, craft.ended = False, ""
            text = f"{uav} is heard again, in {state.mode} at {place_text(state)}."
            return [Event(INFO, "vehicle", uav, text)]
        text = (
            f"{uav} is lost: not heard for {silent_s:.0f} s, "
            f"last {'before the restart' if never else f'in {state.mode} at {place_text(state)}'}"
        )
        return self._told(craft, [Event(ERROR, "vehicle", uav, text)])

    def _told(self, craft: _Craft, events: list[Event]) -> list[Event]:
        """Notices with what the others do, and the waypoints that a vehicle gives up."""
        found = []
        for event in events:
            others = [u for u in self.flying if u != event.uav_id and not self._leaving(u)]
            rest = f"; {', '.join(others)} fl{'y' if len(others) > 1 else 'ies'} on"
            text = event.text + (rest if others and event.level > INFO else "")
            found.append(replace(event, text=f"{text}."))
        state = craft.state
        ordered = state.ordered and not craft.silent
        if events and (craft.silent or state.mode in LEAVING) and not ordered and not craft.left:
            found += self._left(craft, state.uav)
        return found

    def _leaving(self, uav: str) -> bool:
        return self._crafts[uav].state.mode in LEAVING

    def _left(self, craft: _Craft, uav: str) -> list[Event]:
        craft.left = True
        ids = self.unvisited(uav)
        if not ids:
            return []
        text = f"{uav} leaves waypoints {', '.join(map(str, ids))}: nobody takes them over."
        return [Event(WARN, "unvisited", uav, text)]

    def _done(self, craft: _Craft, state: LinkState) -> list[Event]:
        if craft.done or self.unvisited(state.uav) or state.mode != "AUTO":
            return []
        craft.done = True
        text = f"{state.uav} has passed all its waypoints and ends its mission."
        return [Event(INFO, "done", state.uav, text)]

    def _landed(self, craft: _Craft, state: LinkState) -> list[Event]:
        craft.flying = False
        home = self._missions[state.uav].home_deg_m
        away_m = distance_m((*state.place[:2], 0.0), (*home[:2], 0.0))
        if away_m <= ON_PAD_M:
            craft.ended = HOME
        else:
            craft.ended = f"landed {away_m:.0f} m from its pad at {place_text(state)}"
        level = INFO if away_m <= ON_PAD_M else WARN
        return [Event(level, "landed", state.uav, f"{state.uav} has {craft.ended}.")]

    def _begun(self, now_s: float) -> list[Event]:
        """Time zero, once all have begun: the one in the middle, so that one odd one is none."""
        begun = [
            c.state.begun for c in self._crafts.values() if c.flying and c.state.begun is not None
        ]
        begun.sort(key=lambda moment: moment.at_s)
        if self.lifted:
            if begun and self.begun is not None and self.begun.utc_ns is None:
                # The vehicle has told its UTC since, perhaps.
                self.begun = begun[(len(begun) - 1) // 2]
            return []
        if not begun or (len(begun) < len(self._crafts) and now_s < begun[0].at_s + TOGETHER_S):
            return []
        self.lifted = True
        self.begun = begun[(len(begun) - 1) // 2]
        missing = [uav for uav in self._crafts if uav not in self.flying]
        text = f"Lift-off: {', '.join(self.flying)}"
        text += f"; {', '.join(missing)} stayed on the ground." if missing else "."
        return [Event(WARN if missing else INFO, "lift_off", "", text)]

    def _over(self) -> list[Event]:
        if self.over or not any(c.flying or c.ended for c in self._crafts.values()):
            return []
        for craft in self._crafts.values():
            if craft.flying and not craft.silent:
                return []
        for craft in self._crafts.values():
            state = craft.state
            if not craft.flying or math.isinf(state.at_s):
                continue
            silent_s = min(state.silent_s, state.at_s - self._since_s)
            if silent_s < max(GIVE_UP_S, 2 * self._lost_after_s):
                return []
            last = f"at {place_text(state)}" if _known(state) else "before the restart"
            craft.ended = f"declared lost, last heard {last}"
        self.over = True
        level = INFO if set(self.ended.values()) == {HOME} else WARN
        hows = "; ".join(f"{uav} {how}" for uav, how in self.ended.items())
        return [Event(level, "landed", "", f"The flight is over: {hows}.")]


def _known(state: LinkState) -> bool:
    """Whether the vehicle has said where it is since this program listens."""
    return not (math.isinf(state.silent_s) or math.isnan(state.place[0]))
