"""How a plan is turned into items: choices, and those with which it is flown as it was timed."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from jfto_mavlink.errors import MissionError
from jfto_mavlink.mission.limits import MissionLimits
from jfto_msgs_py.records.plan import Plan
from jfto_world.mission.encoding import MOUNTS, SHUTTERS, Encoding
from jfto_world.motion.arducopter import ArduCopter

STYLES = ("fly_through", "hold")


@dataclass(frozen=True)
class MissionSettings:
    """Choices that a plan leaves open.

    `style` "fly_through" takes photos at up to full speed and tilt; "hold" stops for `hold_s` at
    each waypoint for sharp ones (5 to 6.5 s longer per waypoint, measured). Waypoints are passed
    within `pass_within_m`; less is slower at corners. After its last waypoint a UAV stays as a
    relay when `relay_until_end` is set, then flies the plan's way home and lands. Without either,
    it climbs to `return_height_m` above home if it is lower, and returns. `gates` are indices along
    each route (0 = first waypoint) behind which all vehicles wait for their planned time plus
    `gate_slack_s`; they need `start_unix_s`, the planned moment of lift-off. `mount`, `shutter` and
    `turn_to_target` are as in `Encoding`.
    """

    style: str = "fly_through"
    hold_s: float = 1.0
    pass_within_m: float = 2.0
    takeoff_height_m: float = 10.0
    shutter: str = "digicam"
    mount: str = "look_at"
    turn_to_target: bool = True
    set_speeds: bool = True
    relay_until_end: bool = True
    return_height_m: float | None = None
    gates: tuple[int, ...] = ()
    gate_slack_s: float = 5.0
    start_unix_s: float | None = None
    terrain_frame: bool = False
    limits: MissionLimits = field(default_factory=MissionLimits)

    @property
    def encoding(self) -> Encoding:
        """Which items photographs take."""
        return Encoding(
            self.mount,
            self.shutter,
            self.turn_to_target,
            self.set_speeds,
            self.relay_until_end,
            self.gates,
        )

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


# Plan files keep millimetres.
_SAME = 0.002


def settings_for(plan: Plan, **choices: Any) -> MissionSettings:
    """Settings of a plan's missions; what is not chosen (None) is as the plan was timed.

    Raises MissionError where a choice is impossible.
    """
    chosen = {name: value for name, value in choices.items() if value is not None}
    planned: dict[str, Any] = {}
    if plan.time_model == "arducopter":
        model = ArduCopter.of_parameters(plan.time_parameters)
        if model.hold_s > 0:
            planned = {"style": "hold", "hold_s": model.hold_s}
        if model.takeoff_m > 0:
            planned["takeoff_height_m"] = model.takeoff_m
    return MissionSettings(**{**planned, **chosen})


def check_as_planned(plan: Plan, settings: MissionSettings) -> None:
    """Raise MissionError where take-off or holds would break the times of the plan."""
    if plan.time_model != "arducopter":
        return
    model = ArduCopter.of_parameters(plan.time_parameters)
    height_m = settings.takeoff_height_m
    if abs(height_m - model.takeoff_m) > _SAME:
        raise MissionError(
            303,
            f"the plan is timed with a lift-off to {model.takeoff_m:g} m, but missions are to "
            f"lift off to {height_m:g} m. Leave the take-off height out to fly as planned, or "
            f"plan anew with trajectory.takeoff_m {height_m:g}.",
        )
    hold_s = settings.hold_s if settings.style == "hold" else 0.0
    if abs(hold_s - model.hold_s) > _SAME:
        planned = f"a hold of {model.hold_s:g} s" if model.hold_s else "no holds"
        wanted = f"hold for {hold_s:g} s" if hold_s else "fly through"
        raise MissionError(
            303,
            f"the plan is timed with {planned} at waypoints, but missions are to {wanted}. Leave "
            f"the style out to fly as planned, or plan anew with trajectory.hold_s {hold_s:g}.",
        )


def require_times_for_gates(plan: Plan) -> None:
    """Raise MissionError where vehicles cannot keep the times of a plan at time gates."""
    if plan.time_model == "constant_speed":
        raise MissionError(
            303,
            "the plan's times are those of constant speed. A vehicle late for a gate waits up to a "
            "minute: plan with trajectory.mode waypoints to use gates.",
        )
