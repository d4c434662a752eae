"""How a plan is turned into items."""

from __future__ import annotations

from dataclasses import dataclass, field

from jfto_mavlink.errors import MissionError
from jfto_mavlink.mission.limits import MissionLimits

STYLES = ("fly_through", "hold")
SHUTTERS = ("digicam", "image_capture", "none")
MOUNTS = ("mount_control", "gimbal_manager", "none")


@dataclass(frozen=True)
class MissionSettings:
    """Choices that a plan leaves open.

    `style` "fly_through" takes photos at up to full speed and tilt; "hold" stops for `hold_s` at
    each waypoint for sharp ones (5 to 6.5 s longer per waypoint, measured). Waypoints are passed
    within `pass_within_m`; less is slower at corners. After its last waypoint a UAV stays as a
    relay until the plan's horizon when `relay_until_end` is set, climbs to `return_height_m` above
    home if it is lower, and returns. `gates` are indices along each route (0 = first waypoint)
    behind which all vehicles wait for their planned time plus `gate_slack_s`;
    they need `start_unix_s`, the planned moment of lift-off.
    """

    style: str = "fly_through"
    hold_s: float = 1.0
    pass_within_m: float = 2.0
    takeoff_height_m: float = 10.0
    shutter: str = "digicam"
    mount: str = "mount_control"
    turn_to_target: bool = True
    set_speeds: bool = True
    relay_until_end: bool = True
    return_height_m: float | None = None
    gates: tuple[int, ...] = ()
    gate_slack_s: float = 5.0
    start_unix_s: float | None = None
    terrain_frame: bool = False
    limits: MissionLimits = field(default_factory=MissionLimits)

    def __post_init__(self) -> None:
        for name, allowed in (("style", STYLES), ("shutter", SHUTTERS), ("mount", MOUNTS)):
            if getattr(self, name) not in allowed:
                raise MissionError(
                    303, f'{name} is "{getattr(self, name)}", must be one of {", ".join(allowed)}.'
                )
        if self.style == "hold" and not self.hold_s >= 1:
            raise MissionError(303, f"hold_s is {self.hold_s}, ArduCopter keeps whole seconds ≥ 1.")
        if not self.takeoff_height_m > 0:
            raise MissionError(303, f"takeoff_height_m is {self.takeoff_height_m}, must be > 0.")
        if self.gates and self.start_unix_s is None:
            raise MissionError(303, "time gates need the planned moment of lift-off.")
        if not 0.1 <= self.pass_within_m <= 10:
            raise MissionError(303, f"pass_within_m is {self.pass_within_m}, must be 0.1…10.")
        if not 0 <= self.gate_slack_s <= 30:
            raise MissionError(
                303,
                f"gate_slack_s is {self.gate_slack_s}, must be 0…30: a gate knows only seconds.",
            )
        if self.terrain_frame:
            raise MissionError(
                304,
                "terrain heights need a TERRAIN_DATA service, which this bridge does not offer: "
                "ArduCopter without loaded terrain descends into the ground. Use heights above "
                "home from the elevation model.",
            )
