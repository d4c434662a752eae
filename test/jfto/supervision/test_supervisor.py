"""The supervisor over small real processes."""

from __future__ import annotations

import json
import os
import signal
import sys
import threading
import time
from dataclasses import replace

import pytest

from jfto.supervision.process import RESTARTS, NodeCommand
from jfto.supervision.supervisor import Death, Supervisor

LIMIT_S = 120.0
# Waiting for the signal itself: one that comes just before a sleep would find it asleep.
WAITER = (
    "import signal\nsignal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])\n"
    "print('up', flush=True)\nsignal.sigwait([signal.SIGINT])\n"
)
SETTINGS = replace(RESTARTS, first_s=0.01, ceiling_s=0.05, tries=3)


@pytest.fixture(autouse=True)
def slow_starts(monkeypatch) -> None:
    """A program that fails at once is up for seconds on a busy computer, and not sound for that."""
    monkeypatch.setattr("jfto.supervision.process.SOUND_AFTER_S", LIMIT_S)


def _node(name: str, code: str) -> NodeCommand:
    return NodeCommand(name, [sys.executable, "-c", code], dict(os.environ))


class _Running:
    """A supervisor in a thread; `told` is what it said."""

    def __init__(self, directory, *nodes: NodeCommand, essential=None) -> None:
        self.directory = directory
        self.told: list[tuple[str, str]] = []
        self.deaths: list[Death] = []
        self.supervisor = Supervisor(
            nodes,
            directory,
            lambda name, text: self.told.append((name, text)),
            SETTINGS,
            essential,
            self.deaths.append,
        )
        self.outcome = None
        self._thread = threading.Thread(target=self._run)

    def _run(self) -> None:
        self.outcome = self.supervisor.run()

    def __enter__(self) -> _Running:
        self._thread.start()
        return self

    def __exit__(self, *exception: object) -> None:
        self.supervisor.stop()
        self._thread.join(LIMIT_S)
        assert not self._thread.is_alive()

    def log(self, name: str) -> str:
        file = self.directory / "logs" / f"{name}.log"
        return file.read_text() if file.exists() else ""

    def state(self, name: str) -> dict:
        return json.loads((self.directory / "status.json").read_text())[name]

    def until(self, condition) -> None:
        tick, end = threading.Event(), time.monotonic() + LIMIT_S
        while not condition():
            assert time.monotonic() < end, self.told
            tick.wait(0.01)


def test_a_killed_node_comes_back_and_all_stop_in_reverse_order(tmp_path) -> None:
    """Killed with -9 it is started again, into the same log; stopping is in reverse order."""
    with _Running(tmp_path, _node("one", WAITER), _node("two", WAITER)) as running:
        running.until(lambda: "up" in running.log("one") and "up" in running.log("two"))
        os.kill(running.state("one")["pid"], signal.SIGKILL)
        running.until(lambda: running.log("one").count("up") == 2)
    stopped = [name for name, text in running.told if text == "stopped"]
    assert stopped == ["two", "one"]
    assert running.outcome.stopped
    assert not running.outcome.failed
    assert not running.outcome.unclean
    assert running.state("one") == {"pid": None, "restarts": 1, "given_up": ""}
    assert any("killed by SIGKILL" in text for _, text in running.told)


def test_a_node_that_keeps_dying_is_given_up(tmp_path) -> None:
    """After a few early deaths the rest is stopped and the outcome names the culprit."""
    with _Running(tmp_path, _node("good", WAITER), _node("bad", "raise SystemExit(7)")) as running:
        running.until(lambda: running.outcome is not None)
    assert list(running.outcome.failed) == ["bad"]
    assert "ended with status 7" in running.outcome.failed["bad"]
    assert not running.outcome.stopped


def test_the_rest_goes_on_without_a_node_that_is_not_essential(tmp_path) -> None:
    """It is given up, whoever listens hears of every death, and the others stay up."""
    good, bad = _node("good", WAITER), _node("bad", "raise SystemExit(7)")
    with _Running(tmp_path, good, bad, essential=["good"]) as running:
        running.until(lambda: running.deaths and running.deaths[-1].again_s is None)
        running.until(lambda: "up" in running.log("good"))
        assert running.outcome is None
    assert {death.how for death in running.deaths} == {"ended with status 7"}
    assert [death.again_s for death in running.deaths] == [0.01, 0.02, 0.04, None]
    assert running.outcome.stopped
    assert list(running.outcome.failed) == ["bad"]


def test_bad_parameters_are_not_tried_again(tmp_path) -> None:
    """Status 2 says that the input is wrong, and it will not mend itself."""
    with _Running(tmp_path, _node("bad", "raise SystemExit(2)")) as running:
        running.until(lambda: running.outcome is not None)
    assert running.state("bad")["restarts"] == 0
    assert running.state("bad")["given_up"]


@pytest.mark.parametrize("code", ["raise SystemExit(3)"])
def test_an_unclean_end_is_reported(tmp_path, code) -> None:
    """A node that answers SIGINT with another status than 0 is named."""
    with _Running(tmp_path, _node("node", WAITER + code)) as running:
        running.until(lambda: "up" in running.log("node"))
    assert running.outcome.unclean == {"node": "ended with status 3"}


@pytest.mark.slow
def test_a_node_that_ignores_sigint_is_asked_by_sigterm(tmp_path) -> None:
    """As under a shell that started everything in the background; it still ends cleanly."""
    deaf = (
        "import signal, threading\nsignal.signal(signal.SIGINT, signal.SIG_IGN)\n"
        "end = threading.Event()\nsignal.signal(signal.SIGTERM, lambda *_: end.set())\n"
        "print('up', flush=True)\nend.wait(60)"
    )
    with _Running(tmp_path, _node("node", deaf)) as running:
        running.until(lambda: "up" in running.log("node"))
    assert running.outcome.unclean == {}
