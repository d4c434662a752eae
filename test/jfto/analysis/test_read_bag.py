"""Reading a flight back from its bag."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from jfto.analysis.read_bag import read_flight
from jfto.analysis.record import READ_BACK, SETPOINT
from jfto.bag.contents import BagError
from jfto.pipeline.run import Run
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.air import AirReport
from jfto_msgs_py.records.event import WARN, Event
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.ros import topics
from support.fleets import START_NS
from support.flights import FlightBag, tracks_of


@pytest.fixture(scope="module")
def plan(tiny_run: tuple[Path, Run]) -> Plan:
    """The tiny scene's plan."""
    return tiny_run[1].plan


@pytest.fixture(scope="module")
def power_w(tiny_run: tuple[Path, Run]) -> np.ndarray:
    """Powers as planned at the desk."""
    comparison = tiny_run[1].comparison
    assert comparison is not None
    return comparison.ours.power_w


def test_tracks_are_on_the_plans_time(plan: Plan, power_w: np.ndarray, tmp_path: Path) -> None:
    """Poses come back at their own stamps, seconds after the lift-off that was announced."""
    bag = FlightBag(tmp_path / "bag")
    tracks = tracks_of(plan)
    bag.lift_off()
    bag.poses(tracks)
    bag.powers(plan, power_w)
    bag.close()
    flight = read_flight([tmp_path / "bag"], plan)
    assert flight.lift_off_ns == START_NS
    assert "announced" in flight.lift_off_source
    for uav, track in tracks.items():
        assert np.allclose(flight.tracks[uav].times_s, track.times_s, atol=1e-8)
        assert np.allclose(flight.tracks[uav].position_m, track.position_m)
    assert flight.complete
    assert flight.notes == ()


def test_powers_without_stamps_are_put_on_the_vehicles_clock(
    plan: Plan, power_w: np.ndarray, tmp_path: Path
) -> None:
    """A flight twelve times faster than the recorder's clock: setpoints still begin with slots."""
    bag = FlightBag(tmp_path / "bag", pace=12.0)
    bag.lift_off()
    bag.poses(tracks_of(plan))
    bag.powers(plan, power_w)
    bag.close()
    flight = read_flight([tmp_path / "bag"], plan)
    steps = flight.powers["uav2"]
    assert steps.source == SETPOINT
    assert np.allclose(steps.times_s, plan.slots.times_s, atol=0.01)
    middle = plan.slots.times_s + 0.5 * plan.slots.duration_s
    assert np.allclose(steps.at(middle), power_w[:, 1])
    assert steps.at(np.array([-1.0])).tolist() == [0.0]


def test_what_radios_say_counts_before_setpoints(
    plan: Plan, power_w: np.ndarray, tmp_path: Path
) -> None:
    """Where a radio's power was read back, the setpoint is not believed."""
    bag = FlightBag(tmp_path / "bag")
    bag.lift_off()
    bag.poses(tracks_of(plan))
    bag.powers(plan, power_w)
    bag.powers(plan, 0.5 * power_w, applied=True)
    bag.close()
    steps = read_flight([tmp_path / "bag"], plan).powers["uav1"]
    assert steps.source == READ_BACK
    assert np.allclose(steps.power_w, 0.5 * power_w[:, 0])


def test_reports_of_the_air_are_in_the_plans_order(plan: Plan, tmp_path: Path) -> None:
    """The air may name the UAVs in any order."""
    ids = ("uav3", "uav1", "uav4", "uav2")
    square = np.arange(16.0).reshape(4, 4)
    bag = FlightBag(tmp_path / "bag")
    bag.lift_off()
    bag.air(
        AirReport(
            stamp_ns=START_NS + 5 * 10**8,
            uav_ids=ids,
            power_w=np.array([3.0, 1.0, 4.0, 2.0]),
            energy_j=np.array([30.0, 10.0, 40.0, 20.0]),
            rate_bps=square,
            delivery=square / 16,
            gain=square,
        )
    )
    bag.close()
    air = read_flight([tmp_path / "bag"], plan).air
    assert air["energy"].values.tolist() == [[10.0, 20.0, 30.0, 40.0]]
    assert air["energy"].times_s.tolist() == [0.5]
    assert air["rate"].values[0][0, 2] == square[1, 0]


def test_events_come_back_once_in_order(plan: Plan, tmp_path: Path) -> None:
    """An event that was latched and recorded twice is one event."""
    first = Event(WARN, "energy", "uav2", "runs short", START_NS + 10**9, "power_node")
    second = dataclasses.replace(first, stamp_ns=START_NS + 2 * 10**9, uav_id="uav3")
    bag = FlightBag(tmp_path / "bag")
    bag.lift_off()
    for event in (second, first, first):
        bag.event(event)
    bag.close()
    assert read_flight([tmp_path / "bag"], plan).events == (first, second)


def test_a_bag_that_lacks_things_says_so(plan: Plan, tmp_path: Path) -> None:
    """Without powers and some poses there is still a flight, and notes name what is missing."""
    bag = FlightBag(tmp_path / "bag")
    bag.lift_off()
    tracks = tracks_of(plan)
    bag.poses({"uav1": tracks["uav1"]})
    bag.close()
    flight = read_flight([tmp_path / "bag"], plan)
    assert flight.notes == (
        "no poses of uav2, uav3, uav4",
        "no powers of uav1, uav2, uav3, uav4",
    )
    assert np.isnan(flight.tracks["uav2"].at(np.array([1.0]))).all()


def test_malformed_messages_are_counted(plan: Plan, tmp_path: Path) -> None:
    """A pose in another frame, and bytes that are no pose, cost themselves only."""
    from geometry_msgs.msg import PoseStamped

    bag = FlightBag(tmp_path / "bag")
    bag.lift_off()
    bag.poses({"uav1": tracks_of(plan)["uav1"]})
    kind = "geometry_msgs/msg/PoseStamped"
    bag.put(topics.pose("uav1"), kind, 1.0, PoseStamped())
    bag.close()
    flight = read_flight([tmp_path / "bag"], plan)
    assert len(flight.tracks["uav1"].times_s) > 100
    assert any("/uav1/pose: header.frame_id" in note for note in flight.notes)


def test_a_recording_that_was_killed_is_read_up_to_there(plan: Plan, tmp_path: Path) -> None:
    """A file cut in the middle gives its whole chunks, and says that it was cut off."""
    path = tmp_path / "bag"
    bag = FlightBag(path)
    bag.lift_off()
    bag._recorder.flush()
    bag.poses(tracks_of(plan))
    bag.close()
    (file,) = path.glob("*.mcap")
    content = file.read_bytes()
    file.write_bytes(content[: len(content) - 60])
    flight = read_flight([path], plan)
    assert not flight.complete
    assert any("cut off" in note for note in flight.notes)
    assert len(flight.tracks["uav1"].times_s) > 100


def test_a_recorder_that_was_started_again_left_two_bags(plan: Plan, tmp_path: Path) -> None:
    """The flight goes on in the second bag; a third that is no bag is noted."""
    tracks = tracks_of(plan)
    track = tracks["uav1"]
    early = track.times_s < 40.0
    for name, kept in (("bag", early), ("bag-2", ~early)):
        bag = FlightBag(tmp_path / name)
        bag.lift_off()
        bag.poses({"uav1": dataclasses.replace(
            track, times_s=track.times_s[kept], position_m=track.position_m[kept]
        )})  # fmt: skip
        bag.close()
    (tmp_path / "bag-3").mkdir()
    paths = [tmp_path / name for name in ("bag", "bag-2", "bag-3")]
    flight = read_flight(paths, plan)
    assert np.allclose(flight.tracks["uav1"].times_s, track.times_s, atol=1e-8)
    assert any("bag-3: cannot be read as a bag" in note for note in flight.notes)


def test_no_bag_and_no_beginning_are_refused(plan: Plan, tmp_path: Path) -> None:
    """A folder that is no bag, and a bag that tells nothing of lift-off, are named."""
    with pytest.raises(BagError, match="does not exist"):
        read_flight([tmp_path / "nope"], plan)
    bag = FlightBag(tmp_path / "bag")
    bag.event(Event(WARN, "energy", "uav2", "runs short", START_NS, "power_node"))
    bag.close()
    with pytest.raises(InputError, match="nothing tells when the flight began"):
        read_flight([tmp_path / "bag"], plan)


def test_lift_off_that_nobody_announced_is_seen(plan: Plan, tmp_path: Path) -> None:
    """Without the bridge's word the climb tells, to a quarter of a second, as poses come."""
    bag = FlightBag(tmp_path / "bag")
    bag.poses(tracks_of(plan))
    bag.close()
    flight = read_flight([tmp_path / "bag"], plan)
    assert abs(flight.lift_off_ns - START_NS) <= 0.25e9
    assert "climb" in flight.lift_off_source
