"""When a plan's lift-off is, on disk, so that a restarted planner keeps to it."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from pathlib import Path

from jfto_msgs_py.files import FileKind, read_record, read_text, write_record
from jfto_msgs_py.plan import Plan
from jfto_msgs_py.plan_file import plan_text
from jfto_msgs_py.plan_reader import PLAN, plan_of_text

_FILE = FileKind(
    "lift-off",
    "Name another file or delete it.",
    format="jfto-lift-off",
    version=2,
    size_limit=10_000,
)


@dataclass(frozen=True)
class LiftOffState:
    """What is known of a plan's start; times are ns since the epoch.

    `planned_ns` is when the plan was made, 0 where that is not known; `start_ns` its time zero;
    `heard` whether the fleet itself has said so. `plan_sha256` says which plan, once it is kept.
    """

    planned_ns: int
    start_ns: int
    heard: bool
    plan_sha256: str = ""


def write_lift_off(plan: Plan, state: LiftOffState, path: Path) -> None:
    """Write a plan's lift-off; raises InputError."""
    write_record(replace(state, plan_sha256=_digest(plan_text(plan))), path, _FILE)


def read_lift_off(plan: Plan, path: Path) -> LiftOffState | None:
    """Lift-off of this very plan, None where the file is not there or for another plan.

    Raises InputError where it is no such file.
    """
    state = _read(path)
    return state if state is not None and state.plan_sha256 == _digest(plan_text(plan)) else None


def sound_plan(plan_file: Path, path: Path) -> Plan | None:
    """The plan of a file if its lift-off is known, None for a plan that was changed since.

    Lift-off is only written of a plan that was found sound. Raises InputError, PlanError.
    """
    text = read_text(plan_file, PLAN.error, PLAN.what, PLAN.size_limit)
    state = _read(path)
    is_same = state is not None and state.plan_sha256 == _digest(text)
    return plan_of_text(text, plan_file) if is_same else None


def _read(path: Path) -> LiftOffState | None:
    return read_record(path, LiftOffState, _FILE) if path.exists() else None


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
