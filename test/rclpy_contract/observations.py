"""What was recorded of the real rclpy, and how a line of it is tried again.

``test/data/ros2/observations.json`` holds the recording, section by section: ``did`` is an
expression or statement, ``saw`` what came of it. Lines of a section ran in order in one process.
"""

import json
import re
import sys
from pathlib import Path

from rclpy_contract.coverage import BY_HAND, LEFT_OUT, PYTHON_3_11

_FILE = Path(__file__).parents[1] / "data" / "ros2" / "observations.json"
RECORDED = json.loads(_FILE.read_text(encoding="utf-8"))
# These tests run with checked message fields, so the lines recorded that way replace the others.
CHECKED = {item["did"]: item["saw"] for item in RECORDED["checked"]}

_ADDRESS = re.compile(r"0x(?:…|[0-9a-f]+)")
# File and line of the C sources are part of the recording but of nobody's contract.
_SOURCE = re.compile(r", result: 2|(?:, at …?[^,:]*:\d+)+")
_INVOKED = re.compile(r"\n+Invoked with.*", re.DOTALL)
_NUMPY_ARRAY_ERROR = re.compile(r"only (?:0-dimensional|length-1|size-1) arrays.*")
# numpy 2 shows its scalars with their type, numpy 1.26 does not.
_NUMPY_SCALAR = re.compile(r"np\.\w+?\((.*?)\)|np\.(True|False)_")
_DBL_MAX = re.compile(r"179769313486231\d{294}")


def normalise(text):
    """Take out what differs from run to run: addresses, source lines, pybind's signatures."""
    text = _ADDRESS.sub("0x…", text)
    text = _SOURCE.sub("", text)
    text = _INVOKED.sub("", text)
    text = _NUMPY_SCALAR.sub(lambda found: found[1] or found[2], text)
    text = _NUMPY_ARRAY_ERROR.sub("only 0-dimensional arrays", text)
    return _DBL_MAX.sub("<DBL_MAX with 309 digits>", text).strip()


def show(error):
    """Write an exception as the recording does."""
    kind = type(error)
    name = kind.__qualname__
    if kind.__module__ != "builtins":
        name = f"{kind.__module__}.{name}"
    text = str(error)
    return f"raises {name}: {text}" if text else f"raises {name} (empty text)"


def attempt(did, environment, shown=None):
    """Run one line and write down what came of it; ``shown`` is an expression to look at after."""
    try:
        try:
            code = compile(did, did, "eval")
        except SyntaxError:
            exec(compile(did, did, "exec"), environment)
            return "accepted" if shown is None else repr(eval(shown, environment))
        result = eval(code, environment)
        if shown is not None:
            result = eval(shown, environment)
    except Exception as error:  # noqa: BLE001 - whatever came is compared
        return show(error)
    return repr(result)


def agrees(saw, came):
    """Whether an outcome is the recorded one."""
    saw, came = normalise(saw), normalise(came)
    if saw == came:
        return True
    # pybind's overload lists are cut off behind the first line.
    if saw.startswith("raises TypeError") and "incompatible" in saw:
        return came.startswith(saw.split("\n", 1)[0].split("incompatible")[0])
    return False


def differences(section, environment, prepare=None):
    """Try the lines of a section in order and list those that came out differently.

    ``prepare(number, line)`` may do something before a line, and may rewrite it.
    """
    found = []
    for number, item in enumerate(RECORDED[section]):
        if number in LEFT_OUT.get(section, {}) or number in BY_HAND.get(section, {}):
            continue
        if sys.version_info[:2] != (3, 11) and number in PYTHON_3_11.get(section, ()):
            continue
        did = item["did"] if prepare is None else prepare(number, item["did"])
        saw = CHECKED.get(item["did"], item["saw"])
        came = attempt(did, environment, item.get("show"))
        if not agrees(saw, came):
            found.append(f"{section}.{number}: {did}\n    saw  {saw}\n    came {came}")
    return found
