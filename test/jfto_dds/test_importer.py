"""The import mechanism: last in line, and only for what is not installed."""

import subprocess
import sys

import pytest

_SCRIPT = """
import sys
import jfto_dds
jfto_dds.install()
jfto_dds.install()
assert sum(isinstance(finder, jfto_dds.RosFinder) for finder in sys.meta_path) == 1
assert isinstance(sys.meta_path[-1], jfto_dds.RosFinder)
import {module}
print(getattr({module}, "__file__", None))
"""


def _run(module, **options):
    return subprocess.run(
        [sys.executable, "-c", _SCRIPT.format(module=module)],
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
        **options,
    )


def test_installed_rclpy_wins(tmp_path, monkeypatch):
    """A real rclpy on the path is imported instead of ours, and so are its submodules."""
    import os
    from pathlib import Path

    import jfto_dds

    (tmp_path / "rclpy").mkdir()
    (tmp_path / "rclpy" / "__init__.py").write_text("REAL = True\n")
    source = str(Path(jfto_dds.__file__).parents[1])
    environment = os.environ | {"PYTHONPATH": os.pathsep.join((str(tmp_path), source))}
    done = _run("rclpy", env=environment)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == str(tmp_path / "rclpy" / "__init__.py")


def test_unknown_names_stay_unknown():
    """Only ROS modules are provided."""
    with pytest.raises(ModuleNotFoundError):
        __import__("nobody_msgs.msg")
    with pytest.raises(ImportError, match="Nope"):
        exec("from std_msgs.msg import Nope")


def test_all_packages_import():
    """Every message package that is known can be imported whole."""
    import importlib

    from jfto_dds.messages.definitions import packages

    for package, kinds in packages().items():
        for kind in kinds:
            module = importlib.import_module(f"{package}.{kind}")
            for name in module.__all__:
                assert getattr(module, name).__module__.startswith(f"{package}.{kind}._")


@pytest.mark.parametrize(
    "statement",
    [
        "from rclpy.action import ActionClient; ActionClient(None, None, 'x')",
        "from rclpy.action import ActionServer; ActionServer()",
        "from rclpy.qos_overriding_options import QoSOverridingOptions; QoSOverridingOptions([])",
    ],
)
def test_what_is_not_supported_says_so(statement):
    """What is missing raises NotImplementedError and is named."""
    with pytest.raises(NotImplementedError, match="jfto_dds does not support"):
        exec(statement)
