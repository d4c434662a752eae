"""DO and CONDITION items of a mission: speed, camera, region of interest, yaw, waits."""

from __future__ import annotations

from collections.abc import Callable

from jfto_sim.camera import Camera
from jfto_sim.flight import Flight
from jfto_sim.mission import items as kinds
from jfto_sim.mission.items import Item
from jfto_sim.motion.waypoint_nav import WaypointNav


class DoItems:
    """Starts items and says when they are done. `watching` means that the nose follows a place.

    `nav` flies the leg to the next waypoint; `change_speed` takes a speed in m/s and its kind.
    """

    def __init__(
        self,
        flight: Flight,
        camera: Camera,
        nav: WaypointNav,
        change_speed: Callable[[float, int], None],
    ) -> None:
        self.watching = False
        self._flight = flight
        self._camera = camera
        self._nav = nav
        self._change_speed = change_speed
        self._begun_s = 0.0

    def start(self, item: Item) -> None:
        """Carry out, or begin to."""
        flight, command, p = self._flight, item.command, item.params
        self._begun_s = flight.clock.time_s
        if command == kinds.CHANGE_SPEED and p[1] > 0:
            self._change_speed(p[1], int(p[0]))
        elif command == kinds.CONDITION_YAW:
            flight.heading.turn_to(p[0], p[1], int(p[2]), relative=bool(p[3]))
        elif command == kinds.SET_ROI:
            if not item.x and not item.y:
                self.look_ahead()
            elif not flight.params["MNT1_TYPE"]:
                self.look_at(item.x, item.y)
        elif (command == kinds.DIGICAM and item.x == 1) or (
            command == kinds.IMAGE_START and p[2] >= 0
        ):
            self._camera.shoot()
        elif command == kinds.CAM_TRIGG_DIST:
            self._camera.every(p[0], at_once=bool(p[2]))
        elif command == kinds.SET_HOME:
            flight.position.set_home(item.x, item.y, item.z_m)
        elif command == kinds.FENCE_ENABLE:
            flight.params.store("FENCE_ENABLE", p[0])

    def look_at(self, lat: int, lon: int) -> None:
        """Point the nose at a place (1e-7 degree) from now on."""
        self.watching = True
        self._flight.heading.look_at(*self._flight.position.local_m(lat, lon))

    def look_ahead(self) -> None:
        """Point the nose along the track again."""
        self.watching = False
        self._flight.heading.follow_track()

    def done(self, item: Item) -> bool:
        """Whether the next DO item may run."""
        command, p = item.command, item.params
        if command == kinds.CONDITION_YAW:
            return self._flight.heading.reached(self._flight.body.yaw_deg)
        if command == kinds.CONDITION_DELAY:
            return self._flight.clock.time_s - self._begun_s >= p[0]
        if command == kinds.CONDITION_DISTANCE:
            return self._nav.distance_m <= p[0]
        return True

    def step(self) -> None:
        """Distance-triggered pictures."""
        self._camera.step()
