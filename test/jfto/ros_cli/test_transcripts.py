"""Every recorded ros2cli command of the verbs that jfto has, run against the same node."""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

import click
import pytest

from jfto.cli.failure import show_error
from jfto.cli.main import cli
from jfto_msgs_py.errors import JftoError

TRANSCRIPTS = Path(__file__).parents[2] / "data" / "ros_cli" / "cli.md"
OURS = {
    "topic": {"list", "info", "echo", "hz", "pub"},
    "node": {"list", "info"},
    "service": {"list", "call"},
    "param": {"list", "get", "set", "dump"},
}
# Why a recorded command is not compared here.
LEFT_OUT = (
    (r" --help$", "help texts are click's, not argparse's"),
    (r" \| head", "a shell pipe; test_processes.py has one"),
    (r"/bad", "the traceback is that of ros2cli's daemon"),
    (r"^service call -r ", "ends by interrupt only"),
    (r"^topic list --spin-time 3", "ends by interrupt before anything is printed"),
    (r"'\{data: \[\}'$", "the traceback is cut in the recording"),
)  # fmt: skip


@dataclass(frozen=True)
class Entry:
    """One recorded command."""

    command: str
    signal: str
    status: int
    out: str
    err: str
    line: int


def _entries():
    text = TRANSCRIPTS.read_text()
    heads = list(re.finditer(r"^`\$ ros2 (.*)` ?(.*?) ?→ exit status \*\*(\d+)\*\*.*$", text, re.M))
    for head, after in zip(heads, [*heads[1:], None], strict=True):
        body = text[head.end() : after.start() if after else len(text)]
        blocks = dict(re.findall(r"^(stdout|stderr):\n```\n(.*?)\n?```$", body, re.M | re.S))
        yield Entry(
            head[1], head[2], int(head[3]), blocks.get("stdout", ""), blocks.get("stderr", ""),
            text.count("\n", 0, head.start()) + 1,
        )  # fmt: skip


def _is_ours(entry):
    words = entry.command.split()
    return len(words) > 1 and words[1] in OURS.get(words[0], ())


def _skip_reason(entry):
    for pattern, reason in LEFT_OUT:
        if re.search(pattern, entry.command):
            return reason
    if "SIG" in entry.signal:
        return "ends by interrupt only"
    return None


ALL = list(_entries())
RECORDED = [entry for entry in ALL if _is_ours(entry)]
COMPARED = [entry for entry in RECORDED if _skip_reason(entry) is None]
# They wait for ever, so that a signal ended the recording; here a time limit ends them.
ENDLESS_ECHOES = [
    entry
    for entry in RECORDED
    if entry.command.startswith("topic echo") and "SIG" in entry.signal
    and "--timeout" not in entry.command
]  # fmt: skip


def run(arguments, session):
    """Run a command in a session that is already there; returns its exit status."""
    try:
        result = cli.main(arguments, prog_name="jfto", standalone_mode=False, obj=session)
        return result if isinstance(result, int) else 0
    except click.ClickException as error:
        error.show()
        return 2
    except JftoError as error:
        return show_error(error, as_json=False)


def _same(text):
    """Text without what differs from run to run."""
    text = re.sub(r"GID: [0-9a-f.]+", "GID: …", text)
    text = re.sub(r"(?<=timestamp: )\d+", "…", text)
    text = re.sub(r"sec=\d{10}, nanosec=\d+", "sec=…, nanosec=…", text)
    text = re.sub(r"_ros2cli_\w+(<32 hex>)?", "_ros2cli_…", text)
    return text.rstrip("\n").replace("\n\n\n", "\n\n")


def _expected_out(entry):
    if "more lines cut here]" in entry.out:
        return _same(entry.out[: entry.out.index("[...")])
    return _same(entry.out)


def _check(entry, session, capsys):
    status = run(shlex.split(entry.command), session)
    out, err = capsys.readouterr()
    where = f"line {entry.line}: {entry.command}"
    if "Setting parameter failed" in entry.err:
        # ros2cli ends with 0 here; jfto says so in its status.
        assert status == 1, where
    else:
        assert status == entry.status, where
    if entry.status == 2:
        # Usage errors: the same status, in click's words.
        assert err, where
        return
    if "cut here" in entry.out:
        assert _same(out).startswith(_expected_out(entry)), where
    else:
        assert _same(out) == _expected_out(entry), where
    expected = entry.err.removeprefix("[Python traceback, then:]\n")
    assert err.rstrip("\n") == expected, where


@pytest.mark.parametrize("group", ["topic list", "topic info", "topic echo", "topic pub",
                                   "topic hz", "node", "service"])  # fmt: skip
def test_output_is_ros2clis(group, session, capsys):
    """Status, stdout and stderr of each recorded command are what the real tool gave."""
    chosen = [entry for entry in COMPARED if entry.command.startswith(group)]
    assert chosen
    failures = []
    for entry in chosen:
        try:
            _check(entry, session, capsys)
        except AssertionError as error:
            failures.append(str(error))
    assert not failures, "\n\n".join(failures)


def test_parameters_in_the_recorded_order(session, demo, capsys):
    """Each param command gives what the real tool gave, changes of earlier ones included."""
    failures = []
    for entry in ALL:
        if entry.command in EFFECTS:
            EFFECTS[entry.command](demo)
        if not entry.command.startswith("param") or entry not in COMPARED:
            continue
        if entry.line == FRESH_NODE_LINE:
            _restore(demo)
        try:
            _check(entry, session, capsys)
        except AssertionError as error:
            failures.append(str(error))
    assert not failures, "\n\n".join(failures)


def _messages(text, by_line):
    """The different messages in an output."""
    parts = text.splitlines() if by_line else re.split(r"\n?---(?:\n|$)", text)
    return {part for part in parts if part}


def _warnings(text):
    """What the command's own node logged; the demo node lives in this process too."""
    return set(re.findall(r"^\[WARN\] \[\S+\] \[_ros2cli_\d+\]: (.*)$", text, re.M))


@pytest.mark.parametrize("entry", ENDLESS_ECHOES, ids=lambda entry: f"line {entry.line}")
def test_echo_that_was_interrupted_prints_the_same(entry, session, capfd):
    """Until it is ended, echo prints the messages, warnings or nothing that the real tool did."""
    assert run([*shlex.split(entry.command), "--timeout", "0.3"], session) == 0
    out, err = capfd.readouterr()
    by_line = "--csv" in entry.command
    assert _messages(out, by_line) == _messages(entry.out, by_line)
    assert _warnings(err) == _warnings(entry.err)


def test_how_much_is_compared():
    """As many recorded commands are compared as the documentation says."""
    assert len(ALL) == 328
    assert len(RECORDED) == 281
    assert len(COMPARED) == 248
    assert len(ENDLESS_ECHOES) == 10


def _set(node, name, value):
    from rclpy.parameter import Parameter

    assert node.set_parameters([Parameter(name, value=value)])[0].successful


# What recorded commands of verbs that jfto does not have did to the node.
EFFECTS = {
    "param delete /uav1/demo dyn": lambda node: node.undeclare_parameter("dyn"),
    "param load /uav1/demo other.yaml": lambda node: _set(node, "speed", 1.0),
}

# Before this one the recording began with a fresh node.
FRESH_NODE_LINE = next(entry.line for entry in RECORDED if entry.command == "param dump /uav1/demo")


def _restore(node):
    from rcl_interfaces.msg import ParameterDescriptor
    from rclpy.parameter import Parameter

    for name, value in {
        "speed": 1.5, "retries": 4, "name": "alpha", "flag": True, "ids": [1, 2, 3],
        "gains": [0.1, 2.0], "names": ["a", "b c"], "flags": [True, False], "whole": 3.0,
        "topo.k_min": 2,
    }.items():  # fmt: skip
        _set(node, name, value)
    node.declare_parameter("dyn", 1, ParameterDescriptor(dynamic_typing=True))
    node.undeclare_parameter("unset")
    node.declare_parameter("unset", Parameter.Type.STRING)
