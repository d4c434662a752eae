"""How photographs are written into a mission."""

from __future__ import annotations

from dataclasses import dataclass

MOUNTS = ("look_at", "mount_control", "gimbal_manager", "none")
SHUTTERS = ("digicam", "image_capture", "none")
TRIGGERS = ("each", "distance", "time")
# What an autopilot holds at least, home included (ArduCopter 4.5.5, measured).
ITEMS_MAX = 650


@dataclass(frozen=True)
class Encoding:
    """Which steps a photograph takes.

    `mount` "look_at" turns nose and camera by one step, towards a far place along the line of
    sight, wherever that is cheaper than the two steps of "mount_control"; those hold until they are
    changed. `turn` says whether the nose is turned at all, `speeds` whether the three speeds are
    set, `gates` behind which waypoints (indices along the route) vehicles wait for their time.
    """

    mount: str = "look_at"
    shutter: str = "digicam"
    turn: bool = True
    speeds: bool = True
    relay: bool = True
    gates: tuple[int, ...] = ()
