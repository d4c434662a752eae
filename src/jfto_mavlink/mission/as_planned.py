"""Missions that are flown as their plan was timed."""

from __future__ import annotations

from typing import Any

from jfto_mavlink.errors import MissionError
from jfto_mavlink.mission.settings import MissionSettings
from jfto_msgs_py.plan import Plan
from jfto_world.motion.arducopter import ArduCopter

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
