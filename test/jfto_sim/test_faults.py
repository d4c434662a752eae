"""The lossy pipe and the fault lines."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import InputError
from jfto_sim import LinkFaults, Vehicle, VehicleConfig
from jfto_sim.control import apply
from jfto_sim.faults import LossyPipe
from jfto_sim.server import Station
from jfto_sim.wind import asked_wind_mps


def through(faults, count=2000, seed=1, spacing_s=0.01):
    pipe = LossyPipe(faults, seed)
    for k in range(count):
        pipe.put(k.to_bytes(4, "big"), k * spacing_s)
    return [int.from_bytes(f, "big") for f in pipe.take(1e9)]


def test_clean_pipe_changes_nothing():
    """Without faults all frames come out in order."""
    assert through(LinkFaults()) == list(range(2000))


def test_loss_is_as_asked():
    """30 % loss loses 30 %, within four standard deviations."""
    arrived = len(through(LinkFaults(loss=0.3)))
    assert abs(arrived - 1400) < 4 * np.sqrt(2000 * 0.3 * 0.7)


def test_duplication_and_reordering():
    """Duplicates appear twice, held-back frames arrive later than their successors."""
    twice = through(LinkFaults(duplication=0.2))
    assert 300 < len(twice) - 2000 < 500
    mixed = through(LinkFaults(reordering=0.2))
    assert sorted(mixed) == list(range(2000))
    assert mixed != sorted(mixed)


def test_delay_holds_frames_back():
    """Nothing arrives before its delay is over."""
    pipe = LossyPipe(LinkFaults(delay_s=0.5), 1)
    pipe.put(b"x", 1.0)
    assert pipe.take(1.499) == []
    assert pipe.take(1.5) == [b"x"]


def test_cut_loses_everything():
    """A cut link passes nothing and counts it."""
    pipe = LossyPipe(LinkFaults(cut=True), 1)
    pipe.put(b"x", 0.0)
    assert (pipe.take(9.0), pipe.lost) == ([], 1)


@given(seed=st.integers(0, 99), loss=st.floats(0, 1), jitter=st.floats(0, 1))
@settings(deadline=None, max_examples=25, derandomize=True)
def test_same_seed_same_fate(seed, loss, jitter):
    """A seed decides every frame's fate."""
    faults = LinkFaults(loss=loss, jitter_s=jitter, duplication=0.1)
    assert through(faults, 100, seed) == through(faults, 100, seed)


@pytest.mark.parametrize(
    "bad", [{"loss": 1.1}, {"loss": -0.1}, {"delay_s": -1}, {"jitter_s": np.nan}]
)
def test_impossible_faults_are_refused(bad):
    """Probabilities and times are checked."""
    with pytest.raises(InputError):
        LinkFaults(**bad)


@pytest.fixture
def stations():
    vehicle = Vehicle(VehicleConfig())
    station = Station(vehicle, [], 1)
    station.links = [{"to": LossyPipe(LinkFaults(), 1), "from": LossyPipe(LinkFaults(), 2)}]
    return {1: station}


def test_a_line_sets_any_parameter(stations):
    """As another station would: in force at once, and nobody invents one."""
    apply(stations, "param 1 WPNAV_SPEED 300")
    assert stations[1].vehicle.flight.limits.wpnav.speed_mps == pytest.approx(3.0)
    with pytest.raises(InputError, match="FENCE_HEIGHT is not a parameter"):
        apply(stations, "param 1 FENCE_HEIGHT 60")


def test_lines_reach_the_vehicle(stations):
    """Each line does what it says."""
    vehicle = stations[1].vehicle
    for line in ("gps 1 off", "motor 1 fail", "battery 1 10.2", "wind 1 5 270", "drift 1 50"):
        apply(stations, line)
    assert vehicle.params["SIM_GPS_DISABLE"] == 1
    assert vehicle.params["SIM_ENGINE_MUL"] == pytest.approx(0.2)
    assert vehicle.battery.voltage_v == pytest.approx(10.2)
    assert asked_wind_mps(vehicle.params, 60.0) == pytest.approx((5.0, 0.0))
    assert vehicle.clock.drift_ppm == 50
    apply(stations, "reboot 1")
    assert vehicle.boots == 2
    apply(stations, "kill 1")
    assert vehicle.dead


def test_link_lines(stations):
    """One direction, one port, all mended."""
    apply(stations, "link 1 loss=0.25 delay_s=0.5 direction=to")
    link = stations[1].links[0]
    assert (link["to"].faults.loss, link["to"].faults.delay_s) == (0.25, 0.5)
    assert link["from"].faults == LinkFaults()
    apply(stations, "link 1 cut=1 port=0")
    assert link["from"].faults.cut
    apply(stations, "mend 1")
    assert link["to"].faults == LinkFaults()


@pytest.mark.parametrize(
    "line",
    ["", "gps", "gps 2 off", "gps 1 sideways", "link 1 colour=1", "link 1 loss=much",
     "link 1 loss=2", "link 1 direction=up", "link 1 port=7 cut=1", "battery 1 full", "kill 1 now"],
)  # fmt: skip
def test_wrong_lines_are_explained(stations, line):
    """Each wrong line is an InputError."""
    with pytest.raises(InputError):
        apply(stations, line)
