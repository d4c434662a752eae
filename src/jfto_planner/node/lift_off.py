"""When a plan begins: provisionally, until the fleet says when it has lifted off.

That is kept on disk, so that a restarted planner keeps to it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.files import FileKind, read_record, read_text, write_record
from jfto_msgs_py.plan_file import PLAN, plan_of_text, plan_text, text_digest
from jfto_msgs_py.records.plan import Plan
from jfto_planner.options import PlannerOptions

# How far ahead a start is kept that waits for the fleet, and how near it may come.
AWAITED_S = 3600.0
_NEAREST_S = 0.5 * AWAITED_S
# The clock of who plans may be behind or ahead of the vehicles'.
_CLOCKS_DIFFER_S = 5.0
# Lift-off is told as it happens; one further ahead is no lift-off.
_AHEAD_S = 60.0
# Nobody hears of a flight for the first time so long after its planned end.
_LONG_OVER_S = 3600.0

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


class LiftOff:
    """Time zero of one plan, kept in the state file of `options` where one is named.

    `made_now` is whether the plan was made just now, not loaded. Raises InputError for a state file
    that cannot be used.
    """

    def __init__(self, plan: Plan, options: PlannerOptions, now_ns: int, *, made_now: bool) -> None:
        self._plan = plan
        self._file = Path(options.state_file) if options.state_file else None
        self._awaits = options.await_lift_off and not options.start_time_s
        known = read_lift_off(plan, self._file) if self._file is not None else None
        if made_now or known is None:
            known = LiftOffState(now_ns if made_now else 0, 0, heard=False)
        delay_s = AWAITED_S if self._awaits else options.start_delay_s
        if options.start_time_s and not known.heard:
            known = replace(known, start_ns=round(options.start_time_s * 1e9))
        elif not known.heard and (self._awaits or not known.start_ns):
            known = replace(known, start_ns=now_ns + round(delay_s * 1e9))
        self._state = known
        self._save()

    @property
    def start_ns(self) -> int:
        """Time zero of the plan, ns since the epoch."""
        return self._state.start_ns

    @property
    def awaited(self) -> bool:
        """Whether the start is no time that anybody has named yet."""
        return self._awaits and not self._state.heard

    def keep_ahead(self, now_ns: int) -> bool:
        """Put an awaited start off before the clock reaches it; whether that was done."""
        if not self.awaited or self._state.start_ns - now_ns > _NEAREST_S * 1e9:
            return False
        self._state = replace(self._state, start_ns=now_ns + round(AWAITED_S * 1e9))
        self._save()
        return True

    def hear(self, lift_off_ns: int, now_ns: int) -> bool:
        """Take over when the fleet lifted off; whether that is news.

        Raises MessageError for a time that this plan cannot have begun at, and InputError where
        the state file cannot be written; then time zero is taken over all the same.
        """
        if self._state.heard and self._state.start_ns == lift_off_ns:
            return False
        self._check(lift_off_ns, now_ns)
        self._state = replace(self._state, start_ns=lift_off_ns, heard=True)
        self._save()
        return True

    def _check(self, lift_off_ns: int, now_ns: int) -> None:
        ahead_s = (lift_off_ns - now_ns) / 1e9
        if ahead_s > _AHEAD_S:
            raise MessageError("lift_off", f"is {ahead_s:.0f} s ahead of this clock")
        before_s = (self._state.planned_ns - lift_off_ns) / 1e9
        if before_s > _CLOCKS_DIFFER_S:
            raise MessageError("lift_off", f"is {before_s:.0f} s before the plan was made")
        if -ahead_s > self._plan.slots.horizon_s + _LONG_OVER_S:
            raise MessageError(
                "lift_off",
                f"is {-ahead_s:.0f} s ago, the plan lasts {self._plan.slots.horizon_s:.0f} s",
            )

    def _save(self) -> None:
        if self._file is not None:
            write_lift_off(self._plan, self._state, self._file)


def write_lift_off(plan: Plan, state: LiftOffState, path: Path) -> None:
    """Write a plan's lift-off; raises InputError."""
    write_record(replace(state, plan_sha256=text_digest(plan_text(plan))), path, _FILE)


def read_lift_off(plan: Plan, path: Path) -> LiftOffState | None:
    """Lift-off of this very plan, None where the file is not there or for another plan.

    Raises InputError where it is no such file.
    """
    state = _read(path)
    return (
        state if state is not None and state.plan_sha256 == text_digest(plan_text(plan)) else None
    )


def sound_plan(plan_file: Path, path: Path) -> Plan | None:
    """The plan of a file if its lift-off is known, None for a plan that was changed since.

    Lift-off is only written of a plan that was found sound. Raises InputError, PlanError.
    """
    text = read_text(plan_file, PLAN.error, PLAN.what, PLAN.size_limit)
    state = _read(path)
    is_same = state is not None and state.plan_sha256 == text_digest(text)
    return plan_of_text(text, plan_file) if is_same else None


def _read(path: Path) -> LiftOffState | None:
    return read_record(path, LiftOffState, _FILE) if path.exists() else None
