"""Rosters."""

from __future__ import annotations

import pytest

from jfto_mavlink.errors import LinkAddressError, RosterError
from jfto_mavlink.roster import parse_roster


def test_a_roster_finds_vehicles_by_link_and_system_id():
    """Never by who was heard first."""
    roster = parse_roster(
        ["a=1@udpin:0.0.0.0:14550", "b=2@udpin:0.0.0.0:14550", "c=3@tcp:h:5760#AB01"]
    )
    assert roster.uavs == ("a", "b", "c")
    assert [str(link) for link in roster.links] == ["udpin:0.0.0.0:14550", "tcp:h:5760"]
    assert roster.find(roster.links[0], 2).uav == "b"
    assert roster.find(roster.links[1], 2) is None
    assert roster.entries[2].uid == "ab01"


@pytest.mark.parametrize(
    ("entries", "words"),
    [
        (["a=1@udpin:h:1", "b=1@udpin:h:2"], "system id 1 stands 2 times"),
        (["a=1@udpin:h:1", "a=2@udpin:h:1"], "UAV name a stands 2 times"),
        (["a=1@udpin:h:1#ff", "b=2@udpin:h:1#ff"], "uid ff stands 2 times"),
        (["a=255@udpin:h:1"], "outside 1…250"),
        (["a@udpin:h:1"], "UAV=SYSID@LINK"),
        ([], "empty"),
    ],
)
def test_a_contradictory_roster_is_refused(entries, words):
    """Two vehicles with one id would be merged silently."""
    with pytest.raises(RosterError, match=words):
        parse_roster(entries)


def test_a_wrong_link_in_a_roster_is_named():
    """The link's own message comes through."""
    with pytest.raises(LinkAddressError, match="udp:h:1"):
        parse_roster(["a=1@udp:h:1"])
