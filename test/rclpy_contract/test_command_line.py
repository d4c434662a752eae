"""Command lines: remapping, parameters, parameter files; recorded as one script's output."""

import re
import warnings

import pytest
import rclpy
from rclpy.node import Node
from std_msgs.msg import String

from rclpy_contract.coverage import LEFT_OUT
from rclpy_contract.observations import RECORDED, normalise

_CASES = [
    pytest.param(item, id=f"{section}.{number}")
    for section in ("cli", "precedence")
    for number, item in enumerate(RECORDED[section])
    if "args" in item and number not in LEFT_OUT.get(section, {})
]
# Which token rcl's lexer expected where, and where libyaml gave up, is their own affair.
_LEXER = re.compile(r"Expected lexeme type .*|near line \d+")
_FILE_OF_P3 = "/uav1/n:\n  ros__parameters:\n    a: 33\n"


def _split(line):
    """Split the recorded command line: ``-p`` values with blanks and quotes are one argument."""
    arguments, rest = [], line
    while rest:
        head, _, rest = rest.partition(" ")
        arguments.append(head)
        if head in ("-p", "--param", "-r", "--remap"):
            # A value reaches to the next flag or rule: it may hold blanks.
            following = re.search(r" (?=-|[\w~/]+:=)", rest)
            end = following.start() if following else len(rest)
            arguments.append(rest[:end])
            rest = rest[end + 1 :]
    return arguments


def _script(arguments):
    """The recorded script: what it printed."""
    lines = []
    rclpy.init(args=arguments)
    node = Node("n", namespace="/uav1", automatically_declare_parameters_from_overrides=True)
    own = ("use_sim_time", "start_type_description_service")
    for name in sorted(node._parameters):
        if name not in own:
            parameter = node._parameters[name]
            lines.append(f"{name} = {parameter.value!r} {parameter.type_.name}")
    publisher = node.create_publisher(String, "chat", 10)
    lines.append(
        f"{node.get_fully_qualified_name()} {node.resolve_topic_name('chat')} "
        f"{node.resolve_topic_name('~/x')} {node.resolve_service_name('srv')} "
        f"{publisher.topic_name} {node.get_logger().name}"
    )
    return "\n".join(lines)


@pytest.mark.parametrize("item", _CASES)
def test_command_line(item, tmp_path, monkeypatch):
    """A command line gives the recorded names and parameters, or the recorded error."""
    monkeypatch.chdir(tmp_path)
    for name, content in item.get("files", {}).items():
        (tmp_path / name).write_text(content)
    if "p3.yaml" in item["args"]:
        (tmp_path / "p3.yaml").write_text(_FILE_OF_P3)
    arguments = _split(item["args"])
    if item["status"] == 0:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            assert _script(arguments) == item["out"].strip()
        return
    with pytest.raises(Exception) as caught:  # noqa: PT011 - the text below says which
        _script(arguments)
    lines = item["err"].strip().splitlines()
    # The recorded text of one error has a line break before the C source's place.
    expected = normalise(lines[-2] if lines[-1].startswith(", at") else lines[-1])
    error = caught.value
    kind = type(error)
    name = kind.__name__ if kind.__module__ == "builtins" else f"{kind.__module__}.{kind.__name__}"
    came = normalise(f"{name}: {error}")
    assert _LEXER.sub("", came) == _LEXER.sub("", expected)
