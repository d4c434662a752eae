"""Borders move towards the sorties that take more."""

from __future__ import annotations

import numpy as np

from jfto_planner.sorties import Load, balanced

LINE = np.column_stack([np.arange(60.0), np.zeros(60), np.zeros(60)])


def test_loads_are_evened_out():
    """The east takes twice as long: its sortie gets fewer waypoints, and both are equally full."""
    effort = np.where(np.arange(60) < 30, 0.015, 0.03)

    def measure(group):
        share = float(effort[group].sum())
        return Load(share, share <= 1.0, float(len(group)))

    assert measure(np.arange(30)).share < 0.6
    split = balanced(LINE, 2, measure)
    shares = [load.share for load in split.loads]
    assert max(shares) < 1.05 * np.mean(shares)
    assert len(split.groups[0]) > len(split.groups[1])


def test_a_broken_sortie_gives_waypoints_away():
    """A sortie that cannot be kept counts as more than full, whatever its share."""

    def measure(group):
        return Load(len(group) / 60, len(group) <= 31 or group[0] == 0, 0.0)

    split = balanced(LINE, 2, measure)
    assert split.clean


def test_too_much_for_all_is_not_tried_again():
    """Where the sorties are more than full on average no border helps; nothing is asked twice."""
    asked = []

    def measure(group):
        asked.append(group.tobytes())
        return Load(len(group) / 10, clean=False, length_m=0.0)

    assert not balanced(LINE, 3, measure).clean
    assert len(asked) == 3
    asked.clear()
    balanced(LINE, 3, lambda group: asked.append(group.tobytes()) or Load(0.5, True, 0.0))
    assert len(asked) == len(set(asked))
