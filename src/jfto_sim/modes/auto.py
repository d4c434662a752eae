"""AUTO: flies the stored mission."""

from __future__ import annotations

from collections.abc import Callable

from jfto_sim.camera import Camera
from jfto_sim.dialect import CRITICAL, Message, mavlink
from jfto_sim.flight import Flight
from jfto_sim.mission import items as kinds
from jfto_sim.mission.fence import Fence
from jfto_sim.mission.items import MISSION, Item, Store
from jfto_sim.mission.runner import MissionRunner, RunState
from jfto_sim.modes.auto_items import TAKEOFFS, DoItems, NavItems, Phase
from jfto_sim.modes.mode import FlightMode, Mode


class Auto(FlightMode):
    """AUTO mode: what the mission runner, the mission protocol and the commands ask of it.

    `terrain_missing` is called where an item counts from the terrain, which is never loaded.
    """

    number = Mode.AUTO

    def __init__(
        self,
        flight: Flight,
        store: Store,
        fence: Fence,
        camera: Camera,
        terrain_missing: Callable[[], None],
    ) -> None:
        super().__init__(flight)
        self.runner = MissionRunner(store, self, flight.ports)
        self.nav_items = NavItems(flight, fence, self.runner.next_nav_after, terrain_missing)
        nav, change_speed = self.nav_items.nav, self.nav_items.change_speed
        self.do_items = DoItems(flight, fence, camera, nav, change_speed)
        self._store = store
        self._camera = camera
        self._may_lift = False
        self._waiting = False
        flight.motors.when_stopped.append(self._motors_stopped)

    # --- mode ---

    def enter(self) -> bool:
        """Refused without a mission once armed, and on the ground without a takeoff item."""
        if self.flight.motors.armed:
            if self._store.count(MISSION) <= 1:
                return False
            if self.flight.body.landed and not self._starts_with_takeoff():
                self.flight.ports.text(CRITICAL, "Auto: Missing Takeoff Cmd")
                return False
        self._waiting = True
        self.nav_items.speed_mps = None
        self.nav_items.hold()
        return True

    def _starts_with_takeoff(self) -> bool:
        for item in self._store.mission[1:]:
            if item.command in TAKEOFFS:
                return True
            if item.is_nav and item.command != kinds.DELAY:
                return False
        return False

    def leave(self) -> None:
        """The mission stops where it is."""
        self.runner.stop()
        self.nav_items.nav.paused = False

    def _motors_stopped(self) -> None:
        self._may_lift = False
        self.runner.reset()

    def _begin(self) -> None:
        """Start or resume the mission, as MIS_RESTART says."""
        if self.flight.params["MIS_RESTART"]:
            self.runner.start()
        else:
            self.runner.resume()

    def mission_start(self) -> None:
        """MISSION_START: the vehicle may lift off; the mission starts if it is not running."""
        self._may_lift = True
        if self.runner.state is not RunState.RUNNING:
            self._begin()

    @property
    def taking_off(self) -> bool:
        """Whether a takeoff item may lift the vehicle."""
        return self.nav_items.phase is Phase.TAKEOFF and self._may_lift

    @property
    def landing(self) -> bool:
        """Whether the present item brings the vehicle down."""
        return self.nav_items.landing

    @property
    def goal(self) -> tuple[float, float]:
        """Distance in metres and bearing in degrees to the end of the leg."""
        return self.nav_items.nav.distance_m, self.nav_items.nav.bearing_deg

    def step(self, dt_s: float) -> None:
        """Run the mission, then the item that is being flown."""
        if self._waiting:
            if not self.flight.position.known:
                return
            self._waiting = False
            self._begin()
        self.runner.update()
        self._camera.step()
        if self.taking_off or not self.flight.body.landed:
            self.nav_items.step(dt_s)

    # --- for the mission protocol ---

    @property
    def on_mission(self) -> bool:
        """Whether the mission is being flown and may not be cleared."""
        return self.active and self.flight.motors.armed

    def mission_edited(self) -> None:
        """Something was stored while flying: begin the present item again and say so."""
        if self._waiting or self.runner.state is not RunState.RUNNING or not self.runner.nav_loaded:
            return
        if self.runner.restart_nav():
            self.flight.ports.text(CRITICAL, "Auto mission changed, restarted command")

    def set_current(self, seq: int) -> bool:
        """Make an item the current one; false if there is no such item."""
        return self.runner.set_current(seq)

    def current_message(self) -> Message:
        """MISSION_CURRENT; 1 no mission, 2 not started, 3 active, 4 paused, 5 complete."""
        if self._store.count(MISSION) <= 1:
            state = 1
        elif not self.active:
            state = 2
        elif self.runner.state is RunState.COMPLETE:
            state = 5
        else:
            state = 4 if self.nav_items.nav.paused else 3
        total = max(0, self._store.count(MISSION) - 1)
        return mavlink.MAVLink_mission_current_message(
            self.runner.nav or 0, total, state, 1 if self.active else 0
        )

    def send_current(self, port: int) -> None:
        """Send MISSION_CURRENT."""
        self.flight.ports.send(port, self.current_message())

    # --- for the mission runner ---

    def mission_complete(self) -> None:
        """Hover where it is; on the ground, stop the motors."""
        self.nav_items.hold()
        if self.flight.body.landed and self.flight.motors.armed:
            self.flight.motors.stop()

    def start_item(self, seq: int, item: Item) -> None:
        """Begin an item."""
        if item.is_nav:
            self.nav_items.start(
                seq, item, nose_free=not (self.do_items.watching or self._turning())
            )
        else:
            self.do_items.start(item)

    def _turning(self) -> bool:
        """Whether the item behind the last waypoint is a CONDITION_YAW, which holds on this leg."""
        do = self.runner.do if self.runner.do_loaded else None
        return do is not None and self._store.mission[do].command == kinds.CONDITION_YAW

    def item_done(self, seq: int, item: Item) -> bool:
        """Whether an item is finished."""
        return self.nav_items.done(seq, item) if item.is_nav else self.do_items.done(item)
