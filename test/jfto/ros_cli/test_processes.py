"""Commands as processes: signals, pipes, statuses."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading

import pytest

from support.spinning import LIMIT_S


def _start(*arguments):
    return subprocess.Popen(
        [sys.executable, "-X", "faulthandler", "-m", "jfto", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def _read_until(process, text):
    """First lines up to the one with a text; the test ends if they do not come."""
    # With faulthandler on, an abort shows where a hanging process hangs.
    watchdog = threading.Timer(LIMIT_S, process.send_signal, [signal.SIGABRT])
    watchdog.start()
    lines = []
    for line in process.stdout:
        lines.append(line)
        if text in line:
            break
    watchdog.cancel()
    return "".join(lines)


@pytest.mark.slow
def test_interrupt_ends_echo_without_a_word(demo):
    """Ctrl-C after two messages: both are whole, stderr is empty, status 130."""
    process = _start("topic", "echo", "/uav1/status")
    head = _read_until(process, "---") + _read_until(process, "---")
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=LIMIT_S)
    assert (process.returncode, err) == (130, "")
    message = "data: 'héllo \"q\" #1: yes'\n---\n"
    assert (head + out).replace(message, "") == ""


@pytest.mark.slow
def test_termination_ends_hz_with_143(demo):
    """SIGTERM ends a rate that is being printed; what was printed is a rate."""
    process = _start("topic", "hz", "/uav1/pose")
    text = _read_until(process, "window")
    process.send_signal(signal.SIGTERM)
    _, err = process.communicate(timeout=LIMIT_S)
    assert (process.returncode, err) == (143, "")
    assert text.startswith("average rate: ")


@pytest.mark.slow
def test_reader_that_leaves_ends_echo(demo):
    """Echo into `head` ends when head does."""
    process = _start("topic", "echo", "/uav1/status")
    _read_until(process, "---")
    process.stdout.close()
    process.stdout = None
    _, err = process.communicate(timeout=LIMIT_S)
    assert (process.returncode, err) == (1, "")


@pytest.mark.slow
def test_refusal_goes_to_stderr(demo):
    """A refused value gives the node's reason and status 1, and changes nothing."""
    refused = _start("param", "set", "/uav1/demo", "speed", "11.0")
    out, err = refused.communicate(timeout=LIMIT_S)
    assert (refused.returncode, out) == (1, "")
    assert err.startswith("Setting parameter failed: Parameter speed out of range")
    assert demo.get_parameter("speed").value == 1.5
