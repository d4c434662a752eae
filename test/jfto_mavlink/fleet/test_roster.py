"""Rosters, and who speaks under a system id."""

from __future__ import annotations

import pytest

from jfto_mavlink.errors import LinkAddressError, RosterError
from jfto_mavlink.fleet.roster import Identity, parse_roster, parse_vehicles


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


A, B = ("127.0.0.1", 1), ("127.0.0.1", 2)


def test_two_uids_under_one_system_id_are_a_conflict_that_stays():
    """Both are named; nothing of the second is believed."""
    identity = Identity("uav1", 1)
    assert identity.heard(A, 0.0)
    identity.version(A, "aa")
    assert not identity.heard(B, 0.1)
    identity.version(B, "bb")
    assert "aa and bb" in identity.conflict
    assert identity.peer == A
    identity.heard(A, 100.0)
    assert identity.conflict


def test_a_vehicle_that_comes_back_on_another_port_is_followed():
    """After a restart the same vehicle may speak from another UDP port."""
    identity = Identity("uav1", 1)
    identity.heard(A, 0.0)
    identity.version(A, "aa")
    assert not identity.heard(B, 1.0)
    identity.version(B, "aa")
    assert identity.heard(B, 1.1)
    assert not identity.conflict


def test_a_second_sender_is_believed_once_the_first_is_silent():
    """Even before it has told its uid."""
    identity = Identity("uav1", 1)
    identity.heard(A, 0.0)
    assert not identity.heard(B, 2.0)
    assert identity.heard(B, 4.0)


def test_one_sender_with_two_uids_is_a_conflict():
    """Two vehicles behind one serial line or router."""
    identity = Identity("uav1", 1)
    identity.heard(None, 0.0)
    identity.version(None, "aa")
    identity.version(None, "bb")
    assert identity.conflict


def test_the_roster_decides_which_vehicle_it_is():
    """Another uid than the roster's is refused by name."""
    identity = Identity("uav1", 1, expected_uid="aa")
    identity.heard(A, 0.0)
    identity.version(A, "cc")
    assert "uav1" in identity.wrong_vehicle
    assert "aa" in identity.wrong_vehicle


def test_a_flood_of_forged_senders_stays_small():
    """Memory does not grow with the number of addresses."""
    identity = Identity("uav1", 1)
    identity.heard(A, 0.0)
    for port in range(1000):
        identity.heard(("10.0.0.1", port), 0.001 * port)
        identity.heard(A, 0.001 * port)
    assert len(identity.unknown_peers()) <= 8
    assert identity.peer == A


@pytest.mark.parametrize(
    ("texts", "endpoints", "entries"),
    [
        (["tcp:a:1", "tcp:b:2"], (), ["uav1 1 tcp:a:1", "uav2 2 tcp:b:2"]),
        (["udpin:0.0.0.0:1"], (), ["uav1 1 udpin:0.0.0.0:1", "uav2 2 udpin:0.0.0.0:1"]),
        ([], ["tcp:a:1"], ["uav1 1 tcp:a:1", "uav2 2 tcp:a:1"]),
        (["uav2=7", "uav1=4@tcp:b:2"], ["tcp:a:1"], ["uav2 7 tcp:a:1", "uav1 4 tcp:b:2"]),
    ],
)
def test_vehicles_of_a_plan_are_named_by_links_or_entries(texts, endpoints, entries):
    """One link for all or one each; system ids 1, 2 and so on where entries do not give them."""
    roster = parse_vehicles(texts, ("uav1", "uav2"), endpoints)
    assert [f"{e.uav} {e.sysid} {e.link}" for e in roster.entries] == entries


def test_vehicles_without_a_plan_are_named_by_their_entries_or_counted():
    """An order to a fleet needs no plan; links are those of uav1, uav2 and so on."""
    assert parse_vehicles(["a=3@tcp:a:1"], ()).uavs == ("a",)
    assert parse_vehicles(["tcp:a:1", "tcp:b:1"], ()).uavs == ("uav1", "uav2")


@pytest.mark.parametrize("text", ["sim", "sim:2"])
def test_simulated_vehicles_have_no_roster(text):
    """Whoever can simulates them on the pads of the plan."""
    assert parse_vehicles([text], ("uav1", "uav2")) is None


@pytest.mark.parametrize(
    ("texts", "uavs", "words"),
    [
        (["sim:3"], ("uav1", "uav2"), "sim:3: the fleet has 2 UAVs, so it must be sim or sim:2"),
        (["sim", "tcp:a:1"], ("uav1", "uav2"), "must be sim or sim:2"),
        (["sim"], (), "stand on the pads of a plan"),
        (["tcp:a:1", "tcp:b:1", "tcp:c:1"], ("uav1", "uav2"), "endpoints has 3"),
        (["uav1"], ("uav1",), "neither a link, such as udpin:0.0.0.0:14550, nor UAV=SYSID@LINK"),
        (["uav1=1@tcp:a:1"], ("uav1", "uav2"), "uav2: in the fleet or in the roster"),
    ],
)
def test_vehicles_that_are_not_the_fleet_are_refused(texts, uavs, words):
    """In one sentence, whichever command was asked."""
    with pytest.raises(RosterError, match=words):
        parse_vehicles(texts, uavs)
