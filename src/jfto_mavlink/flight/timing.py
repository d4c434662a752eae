"""When one vehicle's flight began, as its plan counts time, and how far along its route it is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from jfto_mavlink.dialect import MODES, Message
from jfto_mavlink.exchange import Context
from jfto_mavlink.flight.follow import Follower, Passage
from jfto_mavlink.flight.start import AIRBORNE
from jfto_mavlink.mission.build import VehicleMission
from jfto_world.motion.arducopter.takeoff import SPOOL_UP_S

# Time zero of a flight on the vehicle's own clock.
UnderWay = Callable[[Context], float | None]


@dataclass(frozen=True)
class Moment:
    """An instant on the bridge's clock, and in UTC as the vehicle has it, if it has."""

    at_s: float
    utc_ns: int | None


class FlightTiming:
    """Fed with all that a vehicle says. The last flight's passages stay until the next begins.

    A mission's plan counts from `SPOOL_UP_S` after the vehicle goes into AUTO, which its heartbeat
    shows at once; a guided flight from when the vehicle is seen off the ground. `under_way` tells
    time zero on the vehicle's own clock, None while it cannot, of a flight that began before this
    program; left out, a flight is taken to be as far as its plan has the last waypoint passed.
    """

    def __init__(
        self, context: Context, mission: VehicleMission, under_way: UnderWay | None = None
    ) -> None:
        self._context, self._mission = context, mission
        self._under_way = under_way
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
        elif not self._flying:
            if vehicle.mode == MODES["AUTO"] and self._auto_s is None:
                self._auto_s = own_s
            if vehicle.landed_state in AIRBORNE:
                self._begin(own_s)
        if self._flying and self._follower is not None:
            self._follower.take(message, own_s)

    def _begin(self, own_s: float) -> None:
        """The vehicle is in the air for the first time."""
        vehicle = self._context.vehicle
        if not self._seen_down:
            self._join(own_s)
            return
        if vehicle.mode == MODES["AUTO"] and self._auto_s is not None:
            self._follower = Follower(self._mission, self._auto_s + SPOOL_UP_S)
        elif vehicle.mode == MODES["GUIDED"]:
            self._follower = Follower(self._mission, own_s)
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
        return [] if follower is None else follower.record.passages[: follower.done]
