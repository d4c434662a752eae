"""A node's process ends within two seconds of a signal, whatever it is doing."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from jfto_msgs_py.ros.run_node import END_S

NODE = """
import sys, threading, time
from rclpy.node import Node
from jfto_msgs_py.ros.run_node import end_process, run_node

class Waiting(Node):
    answers_later = {later}

    def __init__(self):
        super().__init__("waiting")
        self.create_timer(0.05, self.work)

    def start(self): pass

    def released(self): print("released", flush=True)

    def work(self):
        print("at work", flush=True)
        {work}

end_process(run_node(Waiting, []))
"""


@pytest.fixture
def started():
    """Starts a node that does `work` in a timer; gone in the end."""
    processes = []

    def start(work: str, *, later: bool = False):
        code = NODE.format(work=work, later=later)
        process = subprocess.Popen(
            [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        processes.append(process)
        while (line := process.stdout.readline()) and "at work" not in line:
            pass
        return process

    yield start
    for process in processes:
        process.kill()
        process.communicate()


@pytest.mark.parametrize("later", [False, True])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_it_ends_cleanly(started, number, later):
    """Status 0, what it keeps is released once, and a second signal while it ends is nothing."""
    process = started("pass", later=later)
    process.send_signal(number)
    process.send_signal(number)
    output, errors = process.communicate(timeout=60)
    assert process.returncode == 0, errors
    assert output.count("released") == 1
    assert not errors


@pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="no /proc")
@pytest.mark.parametrize("later", [False, True])
def test_it_leaves_nothing_in_shared_memory(started, later):
    """The participant ends before the process does, and removes its segment and its ports."""
    process = started("pass", later=later)
    links = {Path(link).resolve() for link in Path(f"/proc/{process.pid}/fd").iterdir()}
    segments = [
        link for link in links if re.fullmatch(r"/dev/shm/fast(rtps|dds)_[0-9a-f]+_el", str(link))
    ]
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
    assert len(segments) == 1
    assert not segments[0].exists()
    assert not segments[0].with_name(segments[0].name[:-3]).exists()


@pytest.mark.slow
def test_it_ends_in_a_computation_that_does_not(started):
    """A callback that never returns is ended from outside: status 1, and the reason is said."""
    process = started("time.sleep(600)")
    begun_s = time.monotonic()
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 1
    assert "Held up" in errors
    assert time.monotonic() - begun_s >= END_S
