"""Cores on a clock that is moved by hand."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.core import CoreRun


@dataclass(frozen=True)
class _Made:
    told: str
    wake_ns: int | None


class _Counter:
    """Wakes up each 20 ns until it has done so three times; a record makes it due at once."""

    def __init__(self) -> None:
        self.left, self.record = 3, ""

    def take(self, record: str, now_ns: int) -> None:
        self.record = f"{record} at {now_ns}"

    def due(self, now_ns: int) -> bool:
        return bool(self.record)

    def step(self, now_ns: int) -> _Made:
        told, self.record = self.record or "woken", ""
        self.left -= told == "woken"
        return _Made(told, now_ns + 20 if self.left > 0 else None)


def test_a_core_wakes_at_its_times_and_steps_on_records_between() -> None:
    """Each at the time it asked for, however far the clock moves at once; then never again."""
    core, log = _Counter(), []
    run = CoreRun(core, 100, lambda now_ns, made: log.append((now_ns, made.told)))
    run.advance(110)
    assert log == []
    run.hand_over(core.take, "first")
    assert log == [(110, "first at 110")]
    run.advance(150)
    assert log[1:] == [(130, "woken"), (150, "woken")]
    run.advance(155)
    run.hand_over(core.take, "second")
    run.advance(10_000)
    assert log[3:] == [(155, "second at 155"), (175, "woken")]
    run.advance(5)
    assert run.now_ns == 10_000


def test_a_record_that_makes_nothing_due_steps_nothing() -> None:
    """It is taken over, and no more."""
    core, log = _Counter(), []
    run = CoreRun(core, 0, lambda *made: log.append(made))
    run.hand_over(lambda record, now_ns: None, "quiet")
    assert log == []
