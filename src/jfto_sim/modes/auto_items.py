"""DO and CONDITION items of a mission: speed, camera, mount, region of interest, yaw, waits."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jfto_sim.mission import items as kinds
from jfto_sim.mission.items import Item

if TYPE_CHECKING:
    from jfto_sim.vehicle import Vehicle


class DoItems:
    """Starts items and says when they are done. `watching` means that the nose follows a place."""

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle
        self.watching = False
        self._begun_s = 0.0

    def start(self, item: Item) -> None:
        """Carry out, or begin to."""
        v, command, p = self.vehicle, item.command, item.params
        self._begun_s = v.time_s
        if command == kinds.CHANGE_SPEED and p[1] > 0:
            v.auto.change_speed(p[1], int(p[0]))
        elif command == kinds.CONDITION_YAW:
            v.heading.turn_to(p[0], p[1], int(p[2]), relative=bool(p[3]))
        elif command == kinds.SET_ROI:
            self._watch(item)
        elif (command == kinds.DIGICAM and item.x == 1) or (
            command == kinds.IMAGE_START and p[2] >= 0
        ):
            v.camera.shoot()
        elif command == kinds.CAM_TRIGG_DIST:
            v.camera.every(p[0], at_once=bool(p[2]))
        elif command in (kinds.MOUNT_CONTROL, kinds.GIMBAL_PITCHYAW):
            v.camera.mount_pitch_deg = p[0]
        elif command == kinds.SET_HOME:
            v.set_home(item.x, item.y, item.z_m)
        elif command == kinds.FENCE_ENABLE:
            v.params.store("FENCE_ENABLE", p[0])

    def _watch(self, item: Item) -> None:
        v = self.vehicle
        if not item.x and not item.y:
            self.watching = False
            v.heading.follow_track()
            return
        if v.params["MNT1_TYPE"]:
            return
        self.watching = True
        east, north, _ = v.local_m(item.x, item.y)
        v.heading.look_at(east, north)

    def done(self, item: Item) -> bool:
        """Whether the next DO item may run."""
        v, command, p = self.vehicle, item.command, item.params
        if command == kinds.CONDITION_YAW:
            return v.heading.reached(v.body.yaw_deg)
        if command == kinds.CONDITION_DELAY:
            return v.time_s - self._begun_s >= p[0]
        if command == kinds.CONDITION_DISTANCE:
            return v.auto.nav.distance_m <= p[0]
        return True

    def step(self) -> None:
        """Distance-triggered pictures."""
        self.vehicle.camera.step()
