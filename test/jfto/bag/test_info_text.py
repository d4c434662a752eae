"""`jfto bag info` against what `ros2 bag info` printed of the same bags."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from jfto.cli.main import main

TRANSCRIPTS = Path(__file__).parents[2] / "data" / "ros_cli" / "bag_cli.md"
# The bags of the other transcripts were not kept.
KEPT = ("jazzy_mcap", "jazzy_sqlite3", "jazzy_mcap_zstd", "nope")


def _entries():
    text = TRANSCRIPTS.read_text()
    heads = list(
        re.finditer(r"^`\$ ros2 bag (info.*?)` → exit status \*\*(\d+)\*\*.*$", text, re.M)
    )
    for head in heads:
        body = text[head.end() :].partition("\n`$ ")[0]
        blocks = dict(re.findall(r"^(stdout|stderr):\n```\n(.*?)\n?```$", body, re.M | re.S))
        words = head[1].split()
        if words[-1].partition("/")[0] in KEPT and "--sort" not in words and "-s" not in words:
            yield pytest.param(words, int(head[2]), blocks, id=head[1])


@pytest.mark.parametrize(("words", "status", "blocks"), list(_entries()))
def test_info_is_rosbag2s(words, status, blocks, bags, capsys):
    """Status and text are what the real tool gave; a usage error differs in the usage line."""
    assert main(["bag", *words]) == status
    out, err = capsys.readouterr()
    assert out.rstrip("\n") == blocks.get("stdout", "").rstrip("\n")
    if status:
        assert err.strip() in blocks["stderr"]


def test_seven_transcripts_are_compared():
    """The list above has not become empty."""
    assert len(list(_entries())) == 7
