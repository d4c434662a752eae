"""What killed participants leave in shared memory, on the real middleware."""

from __future__ import annotations

import fcntl
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from jfto.supervision.process import RESTARTS, NodeCommand
from jfto.supervision.shared_memory import FOLDER, SharedMemory
from jfto.supervision.supervisor import Supervisor

LIMIT_S = 90.0
# Talks, counts what it hears of others, and prints the count.
NODE = """
import sys, rclpy
from std_msgs.msg import String
rclpy.init(args=[], domain_id=int(sys.argv[1]))
node = rclpy.create_node(f"node{sys.argv[2]}")
talk = node.create_publisher(String, "talk", 10)
heard = []
node.create_subscription(String, "talk", lambda m: m.data == sys.argv[2] or heard.append(m), 10)
node.create_timer(0.05, lambda: talk.publish(String(data=sys.argv[2])))
node.create_timer(0.05, lambda: print(len(heard), flush=True))
print(0, flush=True)
rclpy.spin(node)
"""
OWN = int(os.environ["ROS_DOMAIN_ID"])
OTHER = OWN % 100 + 1

pytestmark = pytest.mark.skipif(not FOLDER.exists(), reason="no shared memory")


class _Node:
    """A process with a participant; `heard` is how many messages of others it has taken."""

    def __init__(self, domain: int, number: int) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-c", NODE, str(domain), str(number)],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        self.heard = -1
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.heard = int(line)

    def kill(self) -> None:
        self.process.kill()
        self.process.wait()
        self._reader.join()
        assert self.process.stdout is not None
        self.process.stdout.close()


def _until(condition: Callable[[], bool]) -> None:
    tick, end = threading.Event(), time.monotonic() + LIMIT_S
    while not condition():
        assert time.monotonic() < end
        tick.wait(0.05)


def _lock_files(pid: int) -> set[Path]:
    """Lock files that a process has open."""
    links = {Path(link).resolve() for link in Path(f"/proc/{pid}/fd").iterdir()}
    return {link for link in links if link.parent == FOLDER and link.name.endswith(("_el", "_sl"))}


def _is_left(lock: Path) -> bool:
    """Whether a lock file or what it stands for is there, and no living process's.

    Ports are numbered from 7000 on in all domains: another program may have taken one since.
    """
    if not lock.exists():
        return lock.with_name(lock.name[:-3]).exists()
    with lock.open("rb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return False
    return True


@pytest.mark.slow
def test_only_what_ones_own_dead_have_left_is_removed() -> None:
    """Two of ours, two of another graph, one of each killed: the other graph's litter stays.

    Whoever lives keeps talking, and one that is started after that is heard.
    """
    memory, of_others = SharedMemory(), SharedMemory()
    nodes = {
        "mine": _Node(OWN, 1), "killed": _Node(OWN, 2),
        "foreign": _Node(OTHER, 3), "foreign killed": _Node(OTHER, 4),
    }  # fmt: skip
    pids = {name: node.process.pid for name, node in nodes.items()}
    try:
        _until(lambda: all(node.heard > 0 for node in nodes.values()))
        files = {name: _lock_files(pid) for name, pid in pids.items()}
        memory.look([pids["mine"], pids["killed"]])
        of_others.look([pids["foreign"], pids["foreign killed"]])
        nodes["foreign killed"].kill()
        nodes["killed"].kill()
        assert set(memory.clear(pids["killed"], killed=True)) <= {
            path.name for path in files["killed"]
        }
        assert not any(_is_left(path) for path in files["killed"])
        assert all(path.exists() for name in ("mine", "foreign") for path in files[name])
        # Nobody can take from those who live, and what others have left is theirs to remove.
        assert (
            memory.clear(pids["mine"], killed=True)
            == of_others.clear(pids["foreign"], killed=True)
            == []
        )
        assert of_others.clear(pids["foreign killed"], killed=True)
        nodes["late"] = _Node(OWN, 5)
        nodes["late foreign"] = _Node(OTHER, 6)
        heard = {name: nodes[name].heard for name in ("mine", "foreign")}
        _until(lambda: all(nodes[name].heard > count + 5 for name, count in heard.items()))
        _until(lambda: nodes["late"].heard > 5 and nodes["late foreign"].heard > 5)
    finally:
        memory.look([node.process.pid for node in nodes.values()])
        for node in nodes.values():
            node.kill()
        for node in nodes.values():
            memory.clear(node.process.pid, killed=True)


def test_a_graph_whose_node_was_killed_leaves_nothing(tmp_path) -> None:
    """The supervisor clears up after the dead, and in the end after those who could not."""
    commands = [
        NodeCommand(f"node{n}", [sys.executable, "-c", NODE, str(OWN), str(n)], dict(os.environ))
        for n in (1, 2)
    ]
    files: set[Path] = set()
    supervisor = Supervisor(
        commands, tmp_path, lambda *_: None, replace(RESTARTS, first_s=0.01, tries=3)
    )
    thread = threading.Thread(target=supervisor.run)
    thread.start()
    try:
        log = tmp_path / "logs" / "node1.log"
        _until(lambda: log.exists() and log.read_text().split()[-1:] > ["0"])
        pids = [slot.process.pid for slot in supervisor._slots]
        _until(lambda: all(len(supervisor._shared_memory._held[pid]) >= 3 for pid in pids))
        files = set.union(*(_lock_files(pid) for pid in pids))
        os.kill(pids[1], signal.SIGKILL)
        _until(lambda: supervisor._slots[1].restarts == 1)
        heard = log.read_text().split()[-1]
        _until(lambda: log.read_text().split()[-1] != heard)
    finally:
        supervisor.stop()
        thread.join()
    assert len(files) >= 6
    assert not any(_is_left(path) for path in files)
