"""One vehicle along its route: when its flight began, what it passed and how late."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from jfto_mavlink.dialect import MODES, Message
from jfto_mavlink.flight.control import AIRBORNE
from jfto_mavlink.mission.build import VehicleMission
from jfto_mavlink.protocol.exchange import Context
from jfto_mavlink.protocol.item import Place, closest_m, offset_m
from jfto_msgs_py.records.passage import Passage
from jfto_world.motion.arducopter.takeoff import SPOOL_UP_S


class Follower:
    """Takes a vehicle's messages and keeps how it passed its waypoints.

    The first `passed` waypoints were passed before, nobody here knows when.
    """

    def __init__(self, mission: VehicleMission, lift_off_s: float, passed: int = 0) -> None:
        self.mission = mission
        self.lift_off_s = lift_off_s
        self.passages = [
            Passage(mission.uav, number, planned_s)
            for number, planned_s in zip(mission.waypoint_ids, mission.arrival_s, strict=True)
        ]
        self._next = passed
        self._last_place: Place | None = None

    def along(self, elapsed_s: float, now_s: float) -> None:
        """The vehicle is so far along its curve; `now_s` is on its own clock."""
        while self._next < len(self.passages):
            passage = self.passages[self._next]
            if elapsed_s < passage.planned_s + PASSED_S:
                return
            late_s = now_s - self.lift_off_s - elapsed_s
            reached_s = passage.planned_s + late_s if passage.closest_m <= PASSED_M else None
            self.passages[self._next] = replace(passage, reached_s=reached_s)
            self._next += 1

    def take(self, message: Message, now_s: float) -> None:
        """Update the passages; `now_s` is on the vehicle's own clock."""
        kind = message.get_type()
        if kind == "GLOBAL_POSITION_INT":
            place = message.lat / 1e7, message.lon / 1e7, message.relative_alt / 1e3
            self._moved(place, now_s)
        elif kind == "MISSION_ITEM_REACHED":
            index = self.mission.item_map.waypoint(message.seq)
            if index is not None:
                self._reached(index, now_s)
        elif kind == "MISSION_CURRENT" and message.seq:
            # Reached messages are sent once: a later item under way says the same.
            index = self.mission.item_map.next_waypoint(message.seq)
            passed = len(self.passages) if index is None else index
            self._reached(passed - 1, now_s)

    def _moved(self, place: Place, now_s: float) -> None:
        start = self._last_place or place
        self._last_place = place
        # The waypoint ahead, and the one just reached: a corner is cut before it is passed.
        for index in (self._next - 1, self._next):
            if 0 <= index < len(self.passages):
                passage = self.passages[index]
                away_m = closest_m(start, place, self.mission.waypoints_deg_m[index])
                nearest_m = min(passage.closest_m, away_m)
                self.passages[index] = replace(passage, closest_m=nearest_m)
        # Of a waypoint inside a line the vehicle knows nothing: its own way tells.
        while self.mission.item_map.inside_line(self._next) and self._is_past(self._next, place):
            self._pass_inside(self._next, now_s)
            self._next += 1

    def _is_past(self, index: int, place: Place) -> bool:
        """Whether the way on, to the next waypoint, has begun."""
        here, following = self.mission.waypoints_deg_m[index : index + 2]
        onwards, gone = offset_m(here, following), offset_m(here, place)
        return sum(a * b for a, b in zip(onwards, gone, strict=True)) >= 0

    def _pass_inside(self, index: int, now_s: float) -> None:
        passage = self.passages[index]
        if passage.closest_m <= PASSED_M:
            self.passages[index] = replace(passage, reached_s=now_s - self.lift_off_s)

    def _reached(self, index: int, now_s: float) -> None:
        for number in range(self._next, index + 1):
            if self.mission.item_map.inside_line(number):
                self._pass_inside(number, now_s)
                continue
            passage = replace(self.passages[number], reached_s=now_s - self.lift_off_s)
            self.passages[number] = passage
        self._next = max(self._next, index + 1)

    @property
    def done(self) -> int:
        """Waypoints reached so far."""
        return self._next


# Time zero of a flight on the vehicle's own clock.
UnderWay = Callable[[Context], float | None]


@dataclass(frozen=True)
class Progressed:
    """A fleet on streamed curves: time zero (ns, the graph's clock), and how far along it is, s."""

    zero_ns: int
    elapsed_s: float


# After a waypoint's time on a curve it is looked how near it was passed.
PASSED_S = 1.0
PASSED_M = 5.0


@dataclass(frozen=True)
class Moment:
    """An instant on the bridge's clock, and in UTC as the vehicle has it, if it has."""

    at_s: float
    utc_ns: int | None


class FlightTiming:
    """Fed with all that a vehicle says. The last flight's passages stay until the next begins.

    A mission's plan counts from `SPOOL_UP_S` after the vehicle goes into AUTO, which its heartbeat
    shows at once. `under_way` tells
    time zero on the vehicle's own clock, None while it cannot, of a flight that began before this
    program; left out, a flight is taken to be as far as its plan has the last waypoint passed.
    With `elapsed_s` the vehicle is streamed to: that tells how far along its curve it is, None
    before, and `under_way` when that began.
    """

    def __init__(
        self,
        context: Context,
        mission: VehicleMission,
        under_way: UnderWay | None = None,
        elapsed_s: Callable[[], float | None] | None = None,
    ) -> None:
        self._context, self._mission = context, mission
        self._under_way, self._elapsed_s = under_way, elapsed_s
        self._follower: Follower | None = None
        self._flying = self._seen_down = False
        self._auto_s: float | None = None

    def take(self, message: Message) -> None:
        """Take in a message, after the vehicle's state has."""
        vehicle = self._context.vehicle
        own_s = vehicle.own_time_s(self._context.clock())
        if not vehicle.armed:
            self._flying, self._auto_s = False, None
            self._seen_down = vehicle.heartbeat_s is not None
        elif self._elapsed_s is not None:
            self._take_streamed(message, own_s, self._elapsed_s())
            return
        elif not self._flying:
            if vehicle.mode == MODES["AUTO"] and self._auto_s is None:
                self._auto_s = own_s
            if vehicle.landed_state in AIRBORNE:
                self._begin(own_s)
        if self._flying and self._follower is not None:
            self._follower.take(message, own_s)

    def _take_streamed(self, message: Message, own_s: float, elapsed_s: float | None) -> None:
        """On a curve its progress counts, not the items of the mission that takes it home."""
        if not self._flying and elapsed_s is not None and self._under_way is not None:
            begun_s = self._under_way(self._context)
            if begun_s is None or self._context.vehicle.landed_state not in AIRBORNE:
                return
            due = [each for each in self._mission.arrival_s if each < elapsed_s]
            self._follower = Follower(self._mission, begun_s, len(due))
            self._flying = True
        if not self._flying or self._follower is None:
            return
        if message.get_type() == "GLOBAL_POSITION_INT":
            self._follower.take(message, own_s)
            if elapsed_s is not None:
                self._follower.along(elapsed_s, own_s)

    def _begin(self, own_s: float) -> None:
        """The vehicle is in the air for the first time."""
        vehicle = self._context.vehicle
        if not self._seen_down:
            self._join(own_s)
            return
        if vehicle.mode == MODES["AUTO"] and self._auto_s is not None:
            self._follower = Follower(self._mission, self._auto_s + SPOOL_UP_S)
        else:
            return
        self._flying = True

    def _join(self, own_s: float) -> None:
        """It was in the air when this program began to listen."""
        current = self._context.vehicle.mission_current
        if current is None:
            return
        index = self._mission.item_map.next_waypoint(current)
        passed = len(self._mission.waypoint_ids) if index is None else index
        begun_s: float | None = own_s - (self._mission.arrival_s[passed - 1] if passed else 0.0)
        if self._under_way is not None:
            begun_s = self._under_way(self._context)
        if begun_s is None:
            return
        self._follower = Follower(self._mission, begun_s, passed)
        self._flying = True

    @property
    def begun(self) -> Moment | None:
        """Time zero of the flight under way."""
        if not self._flying or self._follower is None:
            return None
        now_s, begun_s = self._context.clock(), self._follower.lift_off_s
        vehicle = self._context.vehicle
        return Moment(now_s - (vehicle.own_time_s(now_s) - begun_s), vehicle.utc_ns(begun_s))

    @property
    def passed(self) -> list[Passage]:
        """Waypoints passed so far."""
        follower = self._follower
        return [] if follower is None else follower.passages[: follower.done]
