"""Troubles that begin and end."""

from __future__ import annotations

from jfto_msgs_py.core import ClockWatch, Episodes


def test_a_trouble_is_told_once_and_its_end_once() -> None:
    """Begun when first seen, over when absent; others do not matter."""
    episodes: Episodes[str] = Episodes()
    assert episodes.update(["a", "b"]) == (["a", "b"], [])
    assert episodes.update(["a"]) == ([], ["b"])
    assert "a" in episodes
    assert "b" not in episodes
    assert episodes.update([]) == ([], ["a"])


def test_a_trouble_that_flickers_is_one() -> None:
    """Over only after three times absent in a row."""
    episodes: Episodes[str] = Episodes(3)
    seen = [episodes.update(each) for each in (["a"], [], [], ["a"], [], [], [], ["a"])]
    assert [began for began, _ in seen] == [["a"], [], [], [], [], [], [], ["a"]]
    assert [over for _, over in seen] == [[], [], [], [], [], [], ["a"], []]


def test_a_clock_set_back_is_noticed_once() -> None:
    """Jitter below a second is none."""
    watch = ClockWatch()
    readings_s = (100.0, 101.0, 100.5, 101.0, 50.0, 50.5)
    assert [watch.set_back_by_ns(round(s * 1e9)) / 1e9 for s in readings_s] == [
        0, 0, 0, 0, 51.0, 0
    ]  # fmt: skip
