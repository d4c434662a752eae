"""What the fleet is at, what was ordered last and what came of it: /jfto/mission/state."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from jfto_mavlink.order_services import FAILED, UNDER_WAY, OrderState
from jfto_msgs_py.ros.diagnostics import ERROR, OK


@dataclass(frozen=True)
class MissionState:
    """`phase` is that of the operation, `alarm` what went wrong last since an order was obeyed."""

    phase: str = "not linked"
    order: OrderState | None = None
    alarm: str = ""

    def in_phase(self, phase: str) -> MissionState:
        """The fleet is at something else."""
        return replace(self, phase=phase)

    def ordered(self, order: OrderState) -> MissionState:
        """An order is under way, done, or has failed."""
        alarm = self.alarm if order.stage == UNDER_WAY else ""
        return replace(self, order=order, alarm=order.text if order.stage == FAILED else alarm)

    def alarmed(self, text: str) -> MissionState:
        """Something went wrong that everybody must know, also who comes later."""
        return replace(self, alarm=text)


def encode_mission_state(state: MissionState) -> Any:
    """diagnostic_msgs/DiagnosticStatus: ERROR with the alarm as its message, if there is one."""
    from diagnostic_msgs.msg import DiagnosticStatus, KeyValue

    order = state.order
    told = "" if order is None else f"{order.verb} {order.stage}"
    facts = {
        "phase": state.phase,
        "order": "" if order is None else order.verb,
        "order_state": "" if order is None else order.stage,
        "order_text": "" if order is None else order.text,
        "alarm": state.alarm,
    }
    return DiagnosticStatus(
        level=bytes([ERROR if state.alarm else OK]),
        name="mission",
        message=state.alarm or ", ".join(part for part in (state.phase, told) if part),
        hardware_id="fleet",
        values=[KeyValue(key=key, value=value) for key, value in facts.items()],
    )
