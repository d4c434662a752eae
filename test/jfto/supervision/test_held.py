"""A directory is one graph's."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import pytest

from jfto.supervision.supervisor import held
from jfto_msgs_py.errors import InputError

HOLDER = """
import sys
from pathlib import Path
from jfto.supervision.supervisor import held
with held(Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


def test_a_second_graph_is_kept_out_until_the_first_is_gone(tmp_path):
    """The error names the other process; one that was killed leaves the directory free."""
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(tmp_path)],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert holder.stdout.readline() == "held\n"
    with pytest.raises(InputError, match=f"process {holder.pid}"), held(tmp_path):
        pass
    os.kill(holder.pid, signal.SIGKILL)
    holder.communicate()
    with held(tmp_path):
        assert (tmp_path / ".in-use").read_text().strip() == str(os.getpid())
