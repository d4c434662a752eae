"""The vehicle's half of recorded uploads, played to our side of the protocol."""

from __future__ import annotations

import pytest

from jfto_mavlink.io.port import Station
from jfto_mavlink.mission.stored import differences
from jfto_mavlink.protocol.item import item_from_message
from jfto_mavlink.protocol.transfer import download
from jfto_mavlink.protocol.upload import Outcome, upload

VEHICLE = 1


def uploads(messages):
    """(items sent by the recorded station, what the vehicle said until its acknowledgement)."""
    found, items, said = [], None, []
    for at_s, message in messages:
        kind, ours = message.get_type(), message.get_srcSystem() != VEHICLE
        if ours and kind == "MISSION_COUNT" and message.mission_type == 0:
            items, said = {}, []
        elif items is None:
            continue
        elif ours and kind == "MISSION_ITEM_INT":
            items[message.seq] = item_from_message(message)
        elif not ours and kind in ("MISSION_REQUEST", "MISSION_ACK"):
            said.append((at_s, message))
            if kind == "MISSION_ACK" and message.type == 0:
                found.append((tuple(items[seq] for seq in sorted(items)), said))
                items = None
    return found


@pytest.mark.parametrize("index", range(5))
def test_a_recorded_vehicle_gets_the_items_it_asks_for(rig, recording, index):
    """Our uploader answers the real autopilot's questions with the very items, and is done."""
    items, said = uploads(recording("02_mission_upload_ok.tlog"))[index]
    rig.context.station = Station(255, 190)
    replies = iter(said)

    def play(message, now_s):
        reply = next(replies, None)
        return [] if reply is None else [(0.004, reply[1])]

    assert rig.run(upload(rig.context, items), play) is Outcome.ACCEPTED
    sent = [item_from_message(m) for _, m in rig.sent if m.get_type() == "MISSION_ITEM_INT"]
    assert tuple(sent) == items


def test_a_recorded_read_back_is_taken_in_and_matches(rig, recording):
    """Items answered by the real autopilot, whichever order we ask in."""
    messages = recording("02_mission_upload_ok.tlog")
    items, said = uploads(messages)[0]
    end_s = said[-1][0]
    held = {}
    for at_s, message in messages:
        if at_s > end_s and message.get_srcSystem() == VEHICLE:
            if message.get_type() == "MISSION_ITEM_INT" and message.seq not in held:
                held[message.seq] = message
            if len(held) == len(items):
                break
    count = next(m for t, m in messages if t > end_s and m.get_type() == "MISSION_COUNT")
    rig.context.station = Station(255, 190)

    def play(message, now_s):
        if message.get_type() == "MISSION_REQUEST_LIST":
            return [(0.004, count)]
        if message.get_type() == "MISSION_REQUEST_INT":
            return [(0.004, held[message.seq])]
        return []

    read = rig.run(download(rig.context), play)
    assert differences(items, read) == ()
    assert rig.sent_types()[-1] == "MISSION_ACK"
