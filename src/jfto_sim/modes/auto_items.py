"""Items of a mission in flight: those that are flown, and those that are done meanwhile."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

from jfto_sim.camera import Camera
from jfto_sim.dialect import INFO
from jfto_sim.flight import Flight
from jfto_sim.mission import items as kinds
from jfto_sim.mission.fence import Fence
from jfto_sim.mission.items import Item
from jfto_sim.modes.mode import Takeoff
from jfto_sim.modes.rtl import Rtl
from jfto_sim.modes.simple import Land
from jfto_sim.motion.waypoint_nav import WaypointNav
from jfto_world.motion.arducopter.wpnav import WpNav

Vector = tuple[float, float, float]
TAKEOFFS = frozenset({kinds.TAKEOFF, kinds.VTOL_TAKEOFF})
_LANDINGS = frozenset({kinds.LAND, kinds.VTOL_LAND})
_FLY_THROUGH_BEFORE = frozenset(
    {kinds.WAYPOINT, kinds.SPLINE, kinds.LOITER_UNLIM, kinds.LOITER_TIME, kinds.PAYLOAD_PLACE}
)
_TURN_S = 30.0
_NOTICED_LATE_S = 0.03  # how much later than the autopilot's own loop a step sees an arrival
_NEVER_S = float("inf")
_SPEED_MAX_MPS = 1000.0


class Phase(Enum):
    """What the vehicle is doing for the present item."""

    HOLD = "hold"
    TAKEOFF = "takeoff"
    FLY = "fly"
    LAND = "land"
    RETURN = "return"


class NavItems:
    """Flies one navigation item at a time and says when it is done; holds without one.

    `following` gives the (seq, item) flown after a seq; `terrain_missing` is called where an item
    counts from the terrain, which is never loaded.
    """

    def __init__(
        self,
        flight: Flight,
        fence: Fence,
        following: Callable[[int], tuple[int, Item] | None],
        terrain_missing: Callable[[], None],
    ) -> None:
        self.nav = WaypointNav(flight.body, flight.limits.wpnav)
        self.phase = Phase.HOLD
        self.speed_mps: float | None = None
        self._flight = flight
        self._following = following
        self._terrain_missing = terrain_missing
        self._takeoff = Takeoff(flight)
        self._land = Land(flight)
        self._rtl = Rtl(flight, fence)
        self._hold_s = 0.0
        self._hold_since_s: float | None = None
        self._delay_until_s = 0.0

    @property
    def landing(self) -> bool:
        """Whether the present item brings the vehicle down."""
        return self.phase is Phase.LAND or (self.phase is Phase.RETURN and self._rtl.landing)

    def hold(self) -> None:
        """Hover where the vehicle can stop."""
        self.phase = Phase.HOLD
        self.nav.start(self._limits())

    def change_speed(self, speed_mps: float, kind: int) -> None:
        """DO_CHANGE_SPEED: at once, on the leg in progress too; 2 is climb, 3 is descent."""
        speed_mps = min(speed_mps, _SPEED_MAX_MPS)
        if kind == 2:
            self._flight.limits.climb_mps = speed_mps
        elif kind == 3:
            self._flight.limits.sink_mps = speed_mps
        else:
            self.speed_mps = speed_mps
        self.refresh_limits()

    def refresh_limits(self) -> None:
        """Take the parameters' speeds, or those that an item asked for."""
        self.nav.set_limits(self._limits())

    def _limits(self) -> WpNav:
        return self._flight.limits.at(0.0 if self.speed_mps is None else 100.0 * self.speed_mps)

    def step(self, dt_s: float) -> None:
        """Move the target by one step."""
        if self.phase is Phase.TAKEOFF:
            self._takeoff.step(dt_s)
        elif self.phase is Phase.LAND:
            self._land.step(dt_s)
        elif self.phase is Phase.RETURN:
            self._rtl.step(dt_s)
        else:
            self.nav.step(dt_s)

    def start(self, seq: int, item: Item, *, nose_free: bool) -> None:
        """Begin an item; the nose follows the track where no DO item holds it (`nose_free`)."""
        self._hold_since_s, self._hold_s = None, 0.0
        if item.command in TAKEOFFS:
            self.phase, self.nav.active = Phase.TAKEOFF, False
            self._takeoff.start(self._height(item))
        elif item.command in _LANDINGS:
            self.phase, self.nav.active = Phase.LAND, False
            placed = item.x or item.y
            self._land.start(self._flight.position.local_m(item.x, item.y) if placed else None)
        elif item.command == kinds.RTL:
            # the autopilot's one waypoint controller now has RTL's speed, and keeps it
            self.phase, self.nav.active, self.speed_mps = Phase.RETURN, False, None
            self._rtl.enter()
        elif item.command == kinds.DELAY:
            self._start_delay(item)
        elif item.command in kinds.LOCATED:
            self._start_waypoint(seq, item, nose_free=nose_free)

    def _start_delay(self, item: Item) -> None:
        wait_s = item.params[0]
        if wait_s <= 0:
            wait_s = self._flight.clock.seconds_until_utc(*item.params[1:])
        self._delay_until_s = self._flight.clock.time_s + wait_s
        self._flight.ports.text(INFO, f"Delaying {int(wait_s)} sec")

    def _start_waypoint(self, seq: int, item: Item, *, nose_free: bool) -> None:
        if not self.nav.active:
            self.nav.start(self._limits())
            if self.phase is Phase.TAKEOFF and self._takeoff.done:
                x, y = self._takeoff.mover.level.position_m
                self.nav.begin((x, y, self._takeoff.height_m))
        self.phase = Phase.FLY
        if item.frame == kinds.TERRAIN and not self._flight.params["TERRAIN_ENABLE"]:
            self._terrain_missing()
            return
        default = self.nav.destination if self.nav.active else self._flight.body.position_m
        place = self._place(item, default)
        self.nav.set_destination(place, wander=True)
        if item.command in (kinds.WAYPOINT, kinds.SPLINE, kinds.LOITER_TIME):
            self._hold_s = item.params[0]
        elif item.command == kinds.LOITER_UNLIM:
            self._hold_s = _NEVER_S
        elif item.command == kinds.LOITER_TURNS:
            self._hold_s = _TURN_S * max(1.0, item.params[0])
        if self._hold_s == 0.0:
            self._look_ahead(seq, item, place)
        if nose_free and int(self._flight.params["WP_YAW_BEHAVIOR"]) == 0:
            self._flight.heading.hold()
        elif nose_free:
            self._flight.heading.follow_track()

    def _look_ahead(self, seq: int, item: Item, place: Vector) -> None:
        """Fly through the waypoint if the item behind it allows that."""
        _, after = self._following(seq) or (None, None)
        if after is None or after.command not in _FLY_THROUGH_BEFORE:
            return
        if (after.frame == kinds.TERRAIN) == (item.frame == kinds.TERRAIN):
            self.nav.set_next(self._place(after, place))

    def done(self, seq: int, item: Item) -> bool:
        """Whether an item is finished."""
        command = item.command
        if command in TAKEOFFS:
            return self._takeoff.done
        if command in _LANDINGS or command == kinds.RTL:
            return self._flight.down_and_still
        if command == kinds.DELAY:
            return self._flight.clock.time_s >= self._delay_until_s
        return command not in kinds.LOCATED or self._waypoint_done(seq, command)

    def _waypoint_done(self, seq: int, command: int) -> bool:
        now = self._flight.clock.time_s
        if not self.nav.reached:
            return False
        if self._hold_since_s is None:
            self._hold_since_s = now - _NOTICED_LATE_S
        if now - self._hold_since_s < self._hold_s:
            return False
        if command in (kinds.WAYPOINT, kinds.SPLINE):
            self._flight.ports.text(INFO, f"Reached command #{seq}")
        return True

    def _height(self, item: Item) -> float:
        """Height above the power-up point."""
        height = self._flight.position.height_of(item.z_m, item.frame)
        assert height is not None  # items without one are refused at upload
        return height

    def _place(self, item: Item, default: Vector) -> Vector:
        if item.x == 0 and item.y == 0:
            east, north = default[0], default[1]
        else:
            east, north = self._flight.position.local_m(item.x, item.y)
        height = default[2] if item.z_m == 0 and not (item.x or item.y) else self._height(item)
        return east, north, height


@dataclass
class DoItems:
    """DO and CONDITION items: speed, camera, region of interest, yaw, waits.

    `nav` flies the leg to the next waypoint; `change_speed` takes a speed in m/s and its kind.
    `watching` means that the nose follows a place.
    """

    flight: Flight
    fence: Fence
    camera: Camera
    nav: WaypointNav
    change_speed: Callable[[float, int], None]
    watching: bool = False
    _begun_s: float = 0.0

    def start(self, item: Item) -> None:
        """Carry out, or begin to."""
        flight, command, p = self.flight, item.command, item.params
        self._begun_s = flight.clock.time_s
        if command == kinds.CHANGE_SPEED and p[1] > 0:
            self.change_speed(p[1], int(p[0]))
        elif command == kinds.CONDITION_YAW:
            self.watching = False
            flight.heading.turn_to(p[0], p[1], int(p[2]), relative=bool(p[3]))
        elif command == kinds.SET_ROI:
            if not item.x and not item.y:
                self.look_ahead()
            elif not flight.params["MNT1_TYPE"]:
                self.look_at(item.x, item.y)
        elif command == kinds.DIGICAM and item.x == 1:
            self.camera.shoot()
        elif command == kinds.IMAGE_START:
            self._capture(p[1], int(p[2]))
        elif command == kinds.IMAGE_STOP:
            self.camera.series(0.0, 0)
        elif command == kinds.CAM_TRIGG_DIST:
            self.camera.every(p[0], at_once=bool(p[2]))
        elif command == kinds.SET_HOME:
            flight.position.set_home(item.x, item.y, item.z_m)
        elif command == kinds.FENCE_ENABLE:
            self.fence.switch(p[0])

    def _capture(self, interval_s: float, count: int) -> None:
        """One picture, or several; none is without end."""
        if count == 1 or (count == 0 and interval_s == 0):
            self.camera.shoot()
        elif count >= 0:
            self.camera.series(interval_s, count or -1)

    def look_at(self, lat: int, lon: int) -> None:
        """Point the nose at a place (1e-7 degree) from now on."""
        self.watching = True
        self.flight.heading.look_at(*self.flight.position.local_m(lat, lon))

    def look_ahead(self) -> None:
        """Point the nose along the track again."""
        self.watching = False
        self.flight.heading.follow_track()

    def done(self, item: Item) -> bool:
        """Whether the next DO item may run."""
        command, p = item.command, item.params
        if command == kinds.CONDITION_YAW:
            return self.flight.heading.reached(self.flight.body.yaw_deg)
        if command == kinds.CONDITION_DELAY:
            return self.flight.clock.time_s - self._begun_s >= p[0]
        if command == kinds.CONDITION_DISTANCE:
            return self.nav.distance_m <= p[0]
        return True
