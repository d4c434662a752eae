"""The lifecycle state machine of REP-2002, as rcl_lifecycle has it."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from .._rclpy_pybind11 import RCLError


class State(NamedTuple):
    """A state: its number and label."""

    id: int
    label: str


class Transition(NamedTuple):
    """A transition between two states."""

    id: int
    label: str
    start: State
    goal: State


STATES = {
    label: State(number, label)
    for number, label in (
        (0, "unknown"),
        (1, "unconfigured"),
        (2, "inactive"),
        (3, "active"),
        (4, "finalized"),
        (10, "configuring"),
        (11, "cleaningup"),
        (12, "shuttingdown"),
        (13, "activating"),
        (14, "deactivating"),
        (15, "errorprocessing"),
    )
}


def _passage(
    number: int, label: str, start: str, busy: str, first: int, success: str, failure: str
) -> list[Transition]:
    """One public transition and the three that end its callback."""
    return [
        Transition(number, label, STATES[start], STATES[busy]),
        Transition(first, "transition_success", STATES[busy], STATES[success]),
        Transition(first + 1, "transition_failure", STATES[busy], STATES[failure]),
        Transition(first + 2, "transition_error", STATES[busy], STATES["errorprocessing"]),
    ]


TRANSITIONS: tuple[Transition, ...] = (
    *_passage(1, "configure", "unconfigured", "configuring", 10, "inactive", "unconfigured"),
    *_passage(2, "cleanup", "inactive", "cleaningup", 20, "unconfigured", "inactive"),
    *_passage(3, "activate", "inactive", "activating", 30, "active", "inactive"),
    *_passage(4, "deactivate", "active", "deactivating", 40, "inactive", "active"),
    Transition(5, "shutdown", STATES["unconfigured"], STATES["shuttingdown"]),
    Transition(6, "shutdown", STATES["inactive"], STATES["shuttingdown"]),
    Transition(7, "shutdown", STATES["active"], STATES["shuttingdown"]),
    Transition(50, "transition_success", STATES["shuttingdown"], STATES["finalized"]),
    Transition(51, "transition_failure", STATES["shuttingdown"], STATES["finalized"]),
    Transition(52, "transition_error", STATES["shuttingdown"], STATES["errorprocessing"]),
    Transition(60, "transition_success", STATES["errorprocessing"], STATES["unconfigured"]),
    Transition(61, "transition_failure", STATES["errorprocessing"], STATES["finalized"]),
    Transition(62, "transition_error", STATES["errorprocessing"], STATES["finalized"]),
)


class StateMachine:
    """Keeps the current state; ``on_transition`` hears of every change."""

    def __init__(self, on_transition: Callable[[Transition], None]) -> None:
        self.current_state = STATES["unconfigured"]
        self._on_transition = on_transition

    def available(self) -> list[Transition]:
        """Transitions that are legal now."""
        return [transition for transition in TRANSITIONS if transition.start == self.current_state]

    def id_of(self, label: str) -> int | None:
        """Number of the legal transition with this label."""
        found = [transition.id for transition in self.available() if transition.label == label]
        return found[0] if found else None

    def trigger_id(self, number: int) -> None:
        """Take a transition by its number; raises RCLError where it is not legal."""
        self._trigger([item for item in self.available() if item.id == number])

    def trigger_label(self, label: str) -> None:
        """Take a transition by its label; raises RCLError where it is not legal."""
        self._trigger([item for item in self.available() if item.label == label])

    def _trigger(self, found: list[Transition]) -> None:
        if not found:
            msg = (
                "Failed to trigger lifecycle state machine transition: "
                "Transition is not registered."
            )
            raise RCLError(msg)
        self.current_state = found[0].goal
        self._on_transition(found[0])
