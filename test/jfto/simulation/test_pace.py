"""How fast simulated vehicles' time may pass."""

from __future__ import annotations

import math

import pytest

from jfto.simulation.pace import FleetPace, PacedFlight, PaceSettings

S = 1_000_000_000
SETTINGS = PaceSettings(ahead_s=0.5, creep=0.1, patience_s=10.0)


def _grant(pace, now_s: float, wall_s: float, passed_s: float = 0.01, **sent_s: float) -> float:
    sent_ns = {uav: round(at_s * S) for uav, at_s in sent_s.items()}
    return pace.grant(round(now_s * S), sent_ns, wall_s, passed_s)


def test_nobody_is_waited_for_who_never_reported() -> None:
    """Nodes that still start, UAVs of which nobody has taken a pose yet."""
    assert _grant(FleetPace(SETTINGS), 1000.0, 0.0, uav1=1000.0) == math.inf


def test_time_goes_on_to_the_limit_and_stands_there() -> None:
    """The slowest counts; after a while time creeps, for the report after one that was lost."""
    pace = FleetPace(SETTINGS)
    pace.node_at("topology_node", round(100.3 * S))
    pace.node_at("power_node", round(100.1 * S))
    assert _grant(pace, 100.4, 0.0) == pytest.approx(0.2)
    assert _grant(pace, 100.6, 0.1, passed_s=0.02) == 0.0
    assert _grant(pace, 100.6, 5.2, passed_s=0.02) == pytest.approx(0.002)
    pace.node_at("power_node", round(100.5 * S))
    assert _grant(pace, 100.6, 5.3) == pytest.approx(0.2)


def test_poses_follow_the_positions_that_were_sent() -> None:
    """However old the last one is: a vehicle that is dark, or far away, holds up nobody.

    At once no more passes than they may be ahead, so that nobody is left behind in one step.
    """
    pace = FleetPace(SETTINGS)
    pace.pose_at("uav1", 100 * S)
    pace.pose_at("uav2", 90 * S)
    assert _grant(pace, 105.0, 0.0, uav1=100.0, uav2=90.0) == 0.5
    assert _grant(pace, 105.0, 0.0, uav1=100.25, uav2=90.0) == pytest.approx(0.25)
    assert _grant(pace, 105.0, 0.0, uav1=100.6, uav2=90.0) == 0.0
    assert pace.given_up == frozenset()


def test_who_does_not_come_on_is_given_up_and_real_time_is_kept() -> None:
    """A node that was killed must not hold up the flight for good, nor be left behind at once."""
    pace = FleetPace(SETTINGS)
    pace.node_at("topology_node", 100 * S)
    pace.node_at("power_node", 110 * S)
    assert _grant(pace, 110.0, 0.0) == 0.0
    assert _grant(pace, 110.1, 10.0) == pytest.approx(0.001)
    assert _grant(pace, 110.1, 10.1, passed_s=0.02) == 0.02
    assert pace.given_up == {"topology_node"}
    # It comes on, if slowly: it is waited for again.
    pace.node_at("topology_node", 101 * S)
    assert _grant(pace, 110.2, 10.2) == 0.0
    assert pace.given_up == frozenset()
    pace.node_at("topology_node", 110 * S)
    assert _grant(pace, 110.2, 10.3) == pytest.approx(0.3)


def test_who_is_gone_for_good_is_no_reason_to_be_slow() -> None:
    """A node that has left the graph is forgotten."""
    pace = FleetPace(SETTINGS)
    pace.node_at("radio_node", 100 * S)
    _grant(pace, 110.0, 0.0)
    assert _grant(pace, 110.0, 11.0) == 0.01
    pace.forget("radio_node")
    assert _grant(pace, 110.0, 11.1) == math.inf
    assert pace.given_up == frozenset()


def test_positions_sent_to_a_bridge_that_died_are_waited_for_by_nobody() -> None:
    """They went with it. Real time is kept while the new one links, as long as patience lasts;
    from its first pose on it is held to what is sent to it.
    """
    pace = FleetPace(SETTINGS)
    pace.pose_at("uav1", 100 * S)
    assert _grant(pace, 101.0, 0.0, uav1=101.0) == 0.0
    pace.pose_source("uav1")
    assert _grant(pace, 101.0, 3.0, passed_s=0.02, uav1=101.0) == 0.02
    pace.pose_at("uav1", 105 * S)
    assert _grant(pace, 105.3, 3.5, uav1=105.25) == pytest.approx(0.25)
    pace.pose_source("uav1")
    assert _grant(pace, 105.3, 4.0, passed_s=0.02, uav1=105.25) == 0.02
    assert _grant(pace, 115.0, 14.1, passed_s=0.02, uav1=105.25) == math.inf


def test_a_flight_knows_how_fast_it_was_and_for_whom_it_waited() -> None:
    """From the first that armed to the last that disarmed; what was before does not count."""
    pace = FleetPace(SETTINGS)
    pace.node_at("topology_node", 0)
    _grant(pace, 1.0, 0.0, passed_s=1.0)
    assert pace.look(2 * S, 1.0, flying=False) is None
    assert pace.look(2 * S, 1.0, flying=True) is None
    pace.pose_at("uav1", 3 * S)
    _grant(pace, 2.0, 2.0, passed_s=0.5, uav1=3.6)
    assert pace.look(60 * S, 9.0, flying=True) is None
    flight = pace.look(82 * S, 11.0, flying=False)
    assert flight == PacedFlight(80.0, 10.0, {"topology_node": 0.5, "uav1's poses": 0.5})
    assert flight.speed == 8.0
    assert pace.look(83 * S, 12.0, flying=False) is None
