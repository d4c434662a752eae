"""When a plan's lift-off is, on disk, so that a restarted planner keeps to it."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from pathlib import Path

from jfto_msgs_py.errors import InputError, PlanError
from jfto_msgs_py.plan import Plan
from jfto_msgs_py.plan_file import PLAN_SIZE_LIMIT, plan_text
from jfto_msgs_py.plan_reader import plan_of_text
from jfto_msgs_py.read_text import read_text
from jfto_msgs_py.write_file import write_file

LIFT_OFF_FORMAT = "jfto-lift-off"
LIFT_OFF_VERSION = 2
_SIZE_LIMIT = 10_000


@dataclass(frozen=True)
class LiftOffState:
    """What is known of a plan's start; times are ns since the epoch.

    `planned_ns` is when the plan was made, 0 where that is not known; `start_ns` its time zero;
    `heard` whether the fleet itself has said so.
    """

    planned_ns: int
    start_ns: int
    heard: bool


def write_lift_off(plan: Plan, state: LiftOffState, path: Path) -> None:
    """Write a plan's lift-off; raises InputError."""
    document = {
        "format": LIFT_OFF_FORMAT,
        "version": LIFT_OFF_VERSION,
        "plan_sha256": _digest(plan_text(plan)),
        **asdict(state),
    }
    write_file(path, json.dumps(document, indent=1) + "\n")


def read_lift_off(plan: Plan, path: Path) -> LiftOffState | None:
    """Lift-off of this very plan, None where the file is not there or for another plan.

    Raises InputError where it is no such file.
    """
    digest, state = _read(path)
    return state if digest == _digest(plan_text(plan)) else None


def sound_plan(plan_file: Path, path: Path) -> Plan | None:
    """The plan of a file if its lift-off is known, None for a plan that was changed since.

    Lift-off is only written of a plan that was found sound. Raises InputError, PlanError.
    """
    text = read_text(plan_file, PlanError, "plan", PLAN_SIZE_LIMIT)
    digest, _ = _read(path)
    return plan_of_text(text, plan_file) if digest == _digest(text) else None


def _read(path: Path) -> tuple[str, LiftOffState | None]:
    """Digest of the plan whose lift-off it is, and the lift-off; "" and None without a file."""
    if not path.exists():
        return "", None
    text = read_text(path, InputError, "lift-off", _SIZE_LIMIT)
    try:
        document = json.loads(text)
        if (document["format"], document["version"]) != (LIFT_OFF_FORMAT, LIFT_OFF_VERSION):
            raise ValueError("other format or version")
        state = LiftOffState(
            int(document["planned_ns"]), int(document["start_ns"]), bool(document["heard"])
        )
        digest = str(document["plan_sha256"])
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(
            f"{path}: does not say when lift-off is ({error!r}). Name another file or delete it."
        ) from None
    return digest, state


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
