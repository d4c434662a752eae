"""Who speaks under a system id."""

from __future__ import annotations

from jfto_mavlink.identity import Identity

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
