"""Loggers: format, levels, filters, environment variables, /rosout."""

import re

import pytest
import rclpy
import rclpy.logging
from rclpy.clock import Clock
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.logging_severity import LoggingSeverity
from rclpy.node import Node

from rclpy_contract.environment import spin_until
from rclpy_contract.observations import RECORDED
from rclpy_contract.scripts import run

_SCRIPT = """
rclpy.init(args=sys.argv)
n = Node("n", namespace="/uav1")
log = n.get_logger()
log.debug("d"); log.info("i"); log.warn("w"); log.warning("w2"); log.error("e"); log.fatal("f")
rclpy.shutdown()
"""
_STAMP = re.compile(r"\[\d{10}\.\d{9}\]")


def _hide(text):
    return _STAMP.sub("[<sec>.<nanosec>]", text)


def test_severities():
    """Everything from INFO on goes to stderr."""
    status, out, err = run(_SCRIPT)
    assert (status, out) == (0, "")
    assert _hide(err) == RECORDED["logging"][0]["err"]


@pytest.mark.parametrize(
    ("number", "argument"), [(2, "uav1.n:=error"), (3, "n:=error"), (4, "WARN"), (5, None)]
)
def test_log_level_arguments(number, argument):
    """Levels by full logger name or for all; the console can be silenced."""
    option = ["--disable-stdout-logs"] if argument is None else ["--log-level", argument]
    status, _, err = run(_SCRIPT, "--ros-args", *option)
    assert status == 0
    assert _hide(err) == RECORDED["logging"][number]["err"]


def test_log_to_stdout():
    """RCUTILS_LOGGING_USE_STDOUT moves all output."""
    status, out, err = run(_SCRIPT, RCUTILS_LOGGING_USE_STDOUT="1")
    assert (status, err) == (0, "")
    assert _hide(out) == RECORDED["logging"][6]["out"]


def test_colours():
    """RCUTILS_COLORIZED_OUTPUT colours lines by severity."""
    _, _, err = run(_SCRIPT, RCUTILS_COLORIZED_OUTPUT="1")
    recorded = re.sub(r"\x1b?(\[\d+m)", "\x1b\\1", RECORDED["logging"][7]["err"])
    assert _hide(err) == recorded


def test_console_format():
    """RCUTILS_CONSOLE_OUTPUT_FORMAT: tokens, and unknown ones left alone."""
    form = "{severity}|{name}|{message}|{function_name}|{nope}"
    _, _, err = run(_SCRIPT, RCUTILS_CONSOLE_OUTPUT_FORMAT=form)
    assert err.splitlines()[0] == "INFO|uav1.n|i|<module>|{nope}"


def test_console_format_times():
    """Times in the format, and escapes."""
    form = "{time}|{time_as_nanoseconds}|{date_time_with_ms}|{short_file_name}|\\t|"
    _, _, err = run(_SCRIPT, RCUTILS_CONSOLE_OUTPUT_FORMAT=form)
    pattern = (
        r"\d{10}\.\d{9}\|\d{19}\|\d{4}-\d\d-\d\d \d\d:\d\d:\d\d\.\d{3}\|\{short_file_name\}\|\t\|"
    )
    assert re.fullmatch(pattern, err.splitlines()[0])


def test_logger_interface(capfd):
    """Names, levels, return values, filters and refusals of a logger."""
    logger = rclpy.logging.get_logger("a")
    assert logger.info("before init") is True
    assert logger.get_child("b").name == "a.b"
    assert logger.get_child("b").get_child("c").info("child") is True
    with pytest.raises(ValueError, match=r"Child logger name must not be empty\."):
        logger.get_child("")
    with pytest.raises(ValueError, match=r"Logger name must not be empty\."):
        rclpy.logging.get_logger("")
    levels = {severity.name: severity.value for severity in LoggingSeverity}
    expected = {"UNSET": 0, "DEBUG": 10, "INFO": 20, "WARN": 30, "ERROR": 40, "FATAL": 50}
    assert levels == expected
    assert logger.get_effective_level() == LoggingSeverity.INFO
    assert logger.is_enabled_for(LoggingSeverity.DEBUG) is False
    assert logger.debug("hidden") is False
    logger.set_level(LoggingSeverity.DEBUG)
    assert logger.debug("now visible") is True
    assert logger.get_child("b").get_effective_level() == LoggingSeverity.DEBUG
    with pytest.raises(ValueError, match="25 is not a valid LoggingSeverity"):
        logger.set_level(25)
    assert rclpy.logging.get_logging_severity_from_string("warn") == LoggingSeverity.WARN
    with pytest.raises(RuntimeError, match="Failed to get severity name"):
        rclpy.logging.get_logging_severity_from_string("nope")
    with pytest.raises(TypeError, match="incompatible function arguments"):
        logger.info(5)
    with pytest.raises(TypeError, match="takes 2 positional arguments but 3 were given"):
        logger.error("%s", 1)
    assert logger.error("line1\nline2") is True
    assert logger.error("") is True
    assert logger.error("named", name="other") is True
    with pytest.raises(TypeError, match='parameter "nope" is not one of the recognized'):
        logger.error("x", nope=True)
    logger.set_level(LoggingSeverity.UNSET)
    text = _hide(capfd.readouterr().err)
    for line in ("[INFO] [<sec>.<nanosec>] [a.b.c]: child", "[a]: line1\nline2", "[other]: named"):
        assert line in text


def test_filters_belong_to_a_line(capfd):
    """once, skip_first and throttle keep their state per source line; changing them is refused."""
    logger = rclpy.logging.get_logger("filters")
    for number in range(5):
        logger.error(f"once {number}", once=True)
        logger.error(f"skip {number}", skip_first=True)
        logger.error(f"throttle {number}", throttle_duration_sec=60.0)
        logger.error(
            f"both {number}", throttle_duration_sec=60.0, throttle_time_source_type=Clock()
        ) if number == 0 else None
    text = capfd.readouterr().err
    shown = [line.rpartition(": ")[2] for line in text.splitlines()]
    assert shown == ["once 0", "throttle 0", "both 0", "skip 1", "skip 2", "skip 3", "skip 4"]

    def same_line(severity, **options):
        return logger.log("x", severity, **options)

    same_line(LoggingSeverity.ERROR, once=True)
    with pytest.raises(ValueError, match="Requested logging filters cannot be changed"):
        same_line(LoggingSeverity.ERROR, skip_first=True)
    with pytest.raises(ValueError, match="Logger severity cannot be changed between calls"):
        same_line(LoggingSeverity.FATAL, once=True)


def test_rosout():
    """/rosout carries what a node's logger and its children say, with the place in the source."""
    rclpy.init(args=[])
    from rcl_interfaces.msg import Log

    node, watcher, got = Node("n", namespace="/uav1"), Node("w"), []
    watcher.create_subscription(Log, "/rosout", got.append, 100)
    executor = SingleThreadedExecutor()
    executor.add_node(watcher)
    assert spin_until(executor, lambda: watcher.count_subscribers("/rosout") == 1)
    node.get_logger().warning("hello")
    node.get_logger().get_child("kid").info("from child")
    rclpy.logging.get_logger("free").info("free")
    assert spin_until(executor, lambda: len(got) >= 2)
    shown = [(log.level, log.name, log.msg, log.file, log.function) for log in got]
    here = "test_logging.py"
    assert shown == [
        (30, "uav1.n", "hello", here, "test_rosout"),
        (20, "uav1.n.kid", "from child", here, "test_rosout"),
    ]
    assert all(log.line > 0 for log in got)
