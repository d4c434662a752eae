"""The parameters of planner_node besides the scenario's."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.records.fields import param


@dataclass(frozen=True)
class PlannerOptions:
    """The planner node's own parameters."""

    autostart: bool = param(True, "Configure and activate at start.")
    plan_file: str = param(
        "", "Plan to load. If there is no such file, the scenario is planned and kept there."
    )
    state_file: str = param(
        "", "File that keeps the lift-off of a plan over a restart; left out: none."
    )
    start_time_s: float = param(
        0.0,
        "Lift-off, seconds since the epoch; 0: as state_file says, else start_delay_s after the "
        "plan is there.",
        unit="s",
        low=0.0,
        high=4e9,
    )
    start_delay_s: float = param(
        5.0, "Time between a plan and its lift-off.", unit="s", low=0.0, high=86_400.0
    )
    await_lift_off: bool = param(
        False,
        "Keep lift-off ahead of the clock until the fleet says on /jfto/mission/lift_off when it "
        "was; start_delay_s then has no effect.",
    )
