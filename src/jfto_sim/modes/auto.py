"""AUTO: flies the stored mission."""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

from jfto_sim.dialect import CRITICAL, INFO, mavlink
from jfto_sim.mission import items as kinds
from jfto_sim.mission.items import Item
from jfto_sim.mission.runner import MissionRunner, RunState
from jfto_sim.modes.auto_items import DoItems
from jfto_sim.modes.base import Descent, FlightMode, Takeoff
from jfto_sim.modes.numbers import Mode
from jfto_sim.modes.rtl import ReturnHome
from jfto_sim.motion.waypoint_nav import WaypointNav
from jfto_world.motion.arducopter.wpnav import WpNav

if TYPE_CHECKING:
    from jfto_sim.vehicle import Vehicle

Vector = tuple[float, float, float]
_FLY_THROUGH_BEFORE = frozenset(
    {kinds.WAYPOINT, kinds.SPLINE, kinds.LOITER_UNLIM, kinds.LOITER_TIME, kinds.PAYLOAD_PLACE}
)
_TURN_S = 30.0
_NOTICED_LATE_S = 0.03  # how much later than the autopilot's own loop a step sees an arrival
_NEVER_S = float("inf")
SPEED_MAX_MPS = 1000.0


class Phase(Enum):
    """What the vehicle is doing for the present item."""

    HOLD = "hold"
    TAKEOFF = "takeoff"
    FLY = "fly"
    LAND = "land"
    RETURN = "return"


class Auto(FlightMode):
    """AUTO mode; also the executor of the mission runner."""

    number = Mode.AUTO

    def __init__(self, vehicle: Vehicle) -> None:
        super().__init__(vehicle)
        self.runner = MissionRunner(vehicle.store, self)
        self.do = DoItems(vehicle)
        self.nav = WaypointNav(vehicle.body, vehicle.wpnav)
        self.takeoff = Takeoff(vehicle)
        self.descent = Descent(vehicle)
        self.home = ReturnHome(vehicle)
        self.phase = Phase.HOLD
        self.may_lift = False
        self.speed_mps: float | None = None
        self._waiting = False
        self._hold_s = 0.0
        self._hold_since_s: float | None = None
        self._delay_until_s = 0.0
        self._touched_down = False

    # --- mode ---

    def enter(self) -> bool:
        """Refused without a mission once armed, and on the ground without a takeoff item."""
        v = self.vehicle
        if v.arming.armed:
            if v.store.count(0) <= 1 or not v.position_ok:
                return False
            if v.body.landed and not self._starts_with_takeoff():
                v.text(CRITICAL, "Auto: Missing Takeoff Cmd")
                return False
        self.speed_mps = None
        self._waiting = True
        self._begin_hold()
        return True

    def _starts_with_takeoff(self) -> bool:
        for item in self.vehicle.store.mission[1:]:
            if item.command in (kinds.TAKEOFF, kinds.VTOL_TAKEOFF):
                return True
            if item.is_nav and item.command != kinds.DELAY:
                return False
        return False

    def leave(self) -> None:
        """The mission stops where it is."""
        self.runner.stop()
        self.nav.paused = False

    def begin(self) -> None:
        """Start or resume the mission, as MIS_RESTART says."""
        self._touched_down = False
        if self.vehicle.params["MIS_RESTART"]:
            self.runner.start()
        else:
            self.runner.resume()

    def mission_start(self) -> None:
        """MISSION_START: the vehicle may lift off; the mission starts if it is not running."""
        self.may_lift = True
        if self.runner.state is not RunState.RUNNING:
            self.begin()

    def mission_edited(self) -> None:
        """Something was stored while flying: begin the present item again and say so."""
        if self._waiting or self.runner.state is not RunState.RUNNING or not self.runner.nav_loaded:
            return
        if self.runner.restart_nav():
            self.vehicle.text(CRITICAL, "Auto mission changed, restarted command")

    def set_paused(self, *, paused: bool) -> None:
        """DO_PAUSE_CONTINUE."""
        self.nav.paused = paused

    def change_speed(self, speed_mps: float, kind: int) -> None:
        """DO_CHANGE_SPEED: at once, on the leg in progress too; 2 is climb, 3 is descent."""
        v = self.vehicle
        if kind == 2:
            v.climb_override_mps = min(speed_mps, SPEED_MAX_MPS)
        elif kind == 3:
            v.sink_override_mps = min(speed_mps, SPEED_MAX_MPS)
        else:
            self.speed_mps = min(speed_mps, SPEED_MAX_MPS)
        self.refresh_limits()

    def refresh_limits(self) -> None:
        """Take the parameters' speeds, or those that an item asked for."""
        self.nav.set_limits(self._limits())

    def _limits(self) -> WpNav:
        speed_cms = 0.0 if self.speed_mps is None else 100.0 * self.speed_mps
        return self.vehicle.wpnav_at(speed_cms)

    @property
    def taking_off(self) -> bool:
        """Whether a takeoff item may lift the vehicle."""
        return self.phase is Phase.TAKEOFF and self.may_lift

    @property
    def landing(self) -> bool:
        """Whether the present item brings the vehicle down."""
        return self.phase is Phase.LAND or (self.phase is Phase.RETURN and self.home.landing)

    def step(self, dt_s: float) -> None:
        """Run the mission, then the item that is being flown."""
        if self._waiting:
            if not self.vehicle.estimator.has_origin(self.vehicle.time_s):
                return
            self._waiting = False
            self.begin()
        self.runner.update()
        self.do.step()
        if self.body.landed and not self.taking_off:
            return
        if self.phase is Phase.TAKEOFF:
            self.takeoff.step(dt_s)
        elif self.phase is Phase.LAND:
            self.descent.step(dt_s)
        elif self.phase is Phase.RETURN:
            self.home.step(dt_s)
        else:
            self.nav.step(dt_s)

    # --- executor of the mission runner ---

    def say(self, text: str) -> None:
        """Tell the stations."""
        self.vehicle.text(INFO, text)

    def reached(self, seq: int) -> None:
        """MISSION_ITEM_REACHED, once, to every port."""
        self.vehicle.broadcast(mavlink.MAVLink_mission_item_reached_message(seq))

    def reports(self, item: Item) -> bool:
        """The mission library's own items are not reported."""
        return item.command not in kinds.UNREPORTED

    def mission_complete(self) -> None:
        """Hover where it is; on the ground, stop the motors."""
        self._begin_hold()
        if self.body.landed and self.vehicle.arming.armed:
            self.vehicle.arming.release()

    def start_item(self, seq: int, item: Item) -> None:
        """Begin an item."""
        if not item.is_nav:
            self.do.start(item)
            return
        self._hold_since_s, self._hold_s = None, 0.0
        command = item.command
        if command in (kinds.TAKEOFF, kinds.VTOL_TAKEOFF):
            self.phase = Phase.TAKEOFF
            self.nav.active = False
            self.takeoff.start(self._height(item))
        elif command in (kinds.LAND, kinds.VTOL_LAND):
            self._start_land(item)
        elif command == kinds.RTL:
            # the autopilot's one waypoint controller now has RTL's speed, and keeps it
            self.phase, self.nav.active, self.speed_mps = Phase.RETURN, False, None
            self.home.start()
        elif command == kinds.DELAY:
            self._start_delay(item)
        elif command in kinds.LOCATED:
            self._start_waypoint(seq, item)

    def _start_land(self, item: Item) -> None:
        self.phase, self.nav.active = Phase.LAND, False
        place = None
        if item.x or item.y:
            east, north, _ = self.vehicle.local_m(item.x, item.y)
            place = (east, north)
        self.descent.start(place)

    def _start_delay(self, item: Item) -> None:
        wait_s = item.params[0]
        if wait_s <= 0:
            wait_s = self.vehicle.seconds_until_utc(*item.params[1:])
        self._delay_until_s = self.vehicle.time_s + wait_s
        self.say(f"Delaying {int(wait_s)} sec")

    def _start_waypoint(self, seq: int, item: Item) -> None:
        if not self.nav.active:
            self.nav.start(self._limits())
            if self.phase is Phase.TAKEOFF and self.takeoff.done:
                x, y = self.takeoff.mover.level.position_m
                self.nav.begin((x, y, self.takeoff.height_m))
        self.phase = Phase.FLY
        if item.frame == kinds.TERRAIN and not self.vehicle.params["TERRAIN_ENABLE"]:
            self.vehicle.failsafes.terrain_missing()
            return
        default = self.nav.destination if self.nav.active else self.body.position_m
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
        self._point_nose()

    def _look_ahead(self, seq: int, item: Item, place: Vector) -> None:
        following = self.runner.next_nav_after(seq)
        if following is None or following[1].command not in _FLY_THROUGH_BEFORE:
            return
        after = following[1]
        if (after.frame == kinds.TERRAIN) == (item.frame == kinds.TERRAIN):
            self.nav.set_next(self._place(after, place))

    def _point_nose(self) -> None:
        behaviour = int(self.vehicle.params["WP_YAW_BEHAVIOR"])
        heading = self.vehicle.heading
        if self.do.watching or self._turning():
            return
        if behaviour == 0:
            heading.hold(heading.demand_deg)
        else:
            heading.follow_track()

    def _turning(self) -> bool:
        """Whether the item behind the last waypoint is a CONDITION_YAW, which holds on this leg."""
        do = self.runner.do
        return (
            self.runner.do_loaded
            and do is not None
            and self.vehicle.store.mission[do].command == kinds.CONDITION_YAW
        )

    def item_done(self, seq: int, item: Item) -> bool:
        """Whether an item is finished."""
        if not item.is_nav:
            return self.do.done(item)
        command = item.command
        if command in (kinds.TAKEOFF, kinds.VTOL_TAKEOFF):
            return self.takeoff.done
        if command in (kinds.LAND, kinds.VTOL_LAND, kinds.RTL):
            return self.vehicle.down_and_still
        if command == kinds.DELAY:
            return self.vehicle.time_s >= self._delay_until_s
        return command not in kinds.LOCATED or self._waypoint_done(seq, command)

    def _waypoint_done(self, seq: int, command: int) -> bool:
        now = self.vehicle.time_s
        if not self.nav.reached:
            return False
        if self._hold_since_s is None:
            self._hold_since_s = now - _NOTICED_LATE_S
        if now - self._hold_since_s < self._hold_s:
            return False
        if command in (kinds.WAYPOINT, kinds.SPLINE):
            self.say(f"Reached command #{seq}")
        return True

    # --- places ---

    def _begin_hold(self) -> None:
        self.phase = Phase.HOLD
        self.nav.start(self._limits())

    def _height(self, item: Item) -> float:
        """Height above the power-up point; unknown terrain counts as sea level."""
        v = self.vehicle
        if item.frame == kinds.RELATIVE:
            return v.home_m[2] + item.z_m
        return item.z_m - v.config.home_alt_m

    def _place(self, item: Item, default: Vector) -> Vector:
        if item.x == 0 and item.y == 0:
            east, north = default[0], default[1]
        else:
            east, north, _ = self.vehicle.local_m(item.x, item.y)
        height = default[2] if item.z_m == 0 and not (item.x or item.y) else self._height(item)
        return east, north, height
