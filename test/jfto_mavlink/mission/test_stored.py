"""What the real autopilot keeps of an item."""

from __future__ import annotations

import dataclasses

import pytest

from jfto_mavlink.mission.stored import differences, mission_hash, stored
from jfto_mavlink.protocol.item import FENCE, MISSION, RALLY, Item, Mission, item_from_message

STATIONS = range(200, 256)


def pairs(recording, name: str) -> list[tuple[Item, Item, int]]:
    """(sent, read back, mission type) for each item that the vehicle read back."""
    sent, found = {}, []
    for _, message in recording(name):
        if message.get_type() != "MISSION_ITEM_INT":
            continue
        key, item = (message.mission_type, message.seq), item_from_message(message)
        if message.get_srcSystem() in STATIONS:
            sent[key] = item
        elif key in sent and key != (MISSION, 0) and sent[key].command == item.command:
            found.append((sent[key], item, message.mission_type))
    return found


@pytest.mark.parametrize(
    ("name", "least"), [("02_mission_upload_ok.tlog", 300), ("02b_mission_item_forms.tlog", 100)]
)
def test_recorded_read_backs_match_what_was_sent(recording, name, least):
    """Frames renamed, params dropped or cut: the stored form of both sides is the same.

    The one exception is a hold beyond 16 bits, which wraps; limits refuse it before sending.
    """
    tested = pairs(recording, name)
    assert len(tested) >= least
    for sent, held, mission_type in tested:
        if sent.params[0] == 70_000:
            continue
        assert stored(sent, mission_type).matches(stored(held, mission_type)), (sent, held)


def test_recorded_fence_and_rally_points_match(recording):
    """Uploads of the other two types, recording 03 case T."""
    kinds = {t for _, _, t in pairs(recording, "03_mission_errors.tlog")}
    assert {FENCE, RALLY} <= kinds


WAYPOINT = Item(16, 3, (2.0, 0.0, 0.0, 0.0), 473_981_912, 85_462_575, 20.0)


@pytest.mark.parametrize(
    "change",
    [
        {"command": 82},
        {"frame": 0},
        {"params": (3.0, 0.0, 0.0, 0.0)},
        {"x": 473_981_913},
        {"y": 85_462_574},
        {"z": 20.05},
    ],
)
def test_each_difference_that_flies_differently_is_seen(change):
    """A wrong command, frame, hold, place or height never passes for the mission sent."""
    home = Item(16, 0)
    sent, held = (home, WAYPOINT), (home, dataclasses.replace(WAYPOINT, **change))
    (text,) = differences(sent, held)
    assert text.startswith("item 1:")
    assert mission_hash(Mission(sent)) != mission_hash(Mission(held))


def test_what_the_autopilot_drops_does_not_count():
    """Heading, radius, fractions of a hold, `current`, and home itself."""
    other = dataclasses.replace(
        WAYPOINT, frame=6, params=(2.7, 3.3, 1.5, float("nan")), current=1, autocontinue=0
    )
    sent, held = (Item(16, 0, x=1), WAYPOINT), (Item(16, 0, x=2), other)
    assert differences(sent, held) == ()
    assert mission_hash(Mission(sent)) == mission_hash(Mission(held))


def test_a_shorter_mission_on_board_is_a_difference():
    """An upload that "succeeds" with fewer items is the classic failure."""
    sent = (Item(16, 0), WAYPOINT, WAYPOINT)
    assert "3 items sent, 2 on board" in differences(sent, sent[:2])[0]
    assert differences((), (Item(16, 0),)) == ()
