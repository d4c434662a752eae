"""Scripts that run in processes of their own, on the same rclpy as the tests."""

import subprocess
import sys

PRELUDE = """
import faulthandler, importlib.util, sys
faulthandler.dump_traceback_later(90, exit=True)
if importlib.util.find_spec("rclpy") is None:
    import jfto_dds
    jfto_dds.install()
import os, signal, threading, time
import rclpy
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger
"""

INIT = "rclpy.init()\n"


def start(body, *arguments, **environment):
    """Start a script; ``environment`` adds variables."""
    import os

    return subprocess.Popen(
        [sys.executable, "-c", PRELUDE + body, *arguments],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | environment,
    )


def run(body, *arguments, **environment):
    """Run a script to its end; returns (exit status, stdout, stderr)."""
    process = start(body, *arguments, **environment)
    out, err = process.communicate(timeout=100)
    return process.returncode, out, err
