"""Errors picked out of a growing log."""

from __future__ import annotations

from jfto.supervision.process import LogTail


def test_each_error_is_told_once_and_in_full(tmp_path) -> None:
    """Half a line waits for its end, repetitions and other levels are left out."""
    log = tmp_path / "node.log"
    tail = LogTail(log)
    assert tail.complaints() == []
    log.write_text("[INFO] [1.0] [n]: fine\n[ERROR] [2.0] [n]: no pl")
    assert tail.complaints() == []
    with log.open("a") as more:
        more.write("an: why\n[ERROR] [3.0] [n]: no plan: why\n[ERROR] [4.0] [n]: other\n")
    assert tail.complaints() == ["no plan: why", "other"]
    assert tail.complaints() == []


def test_what_was_there_before_is_not_news(tmp_path) -> None:
    """A log of an earlier run is only read from its end on."""
    log = tmp_path / "node.log"
    log.write_text("[ERROR] [1.0] [n]: old\n")
    tail = LogTail(log)
    assert tail.complaints() == []
