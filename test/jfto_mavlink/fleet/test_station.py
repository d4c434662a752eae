"""The ground station and simulated vehicles, in virtual time: every misfortune of a mission."""

from __future__ import annotations

import dataclasses
import hashlib
import random

import pytest

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.errors import CommandError, FlightError, RosterError, SigningError, TransferError
from jfto_mavlink.fleet.fly import deliver_to_fleet
from jfto_mavlink.io.port import Station
from jfto_mavlink.io.signing import Signer
from jfto_mavlink.mission.deliver import clear, deliver, verify
from jfto_mavlink.mission.fence import Circle, Fence, RallyPoint, fence_items, rally_items
from jfto_mavlink.protocol.item import MISSION, Item, Mission
from jfto_mavlink.protocol.parameter import read_parameter, set_parameter
from jfto_mavlink.protocol.setup import setup_signing
from jfto_mavlink.protocol.transfer import download
from jfto_mavlink.protocol.upload import upload
from jfto_sim import LinkFaults, Vehicle, VehicleConfig
from support.rehearsal import CLEAN, Rehearsal

KEY = hashlib.sha256(b"test key one").digest()


def mission(items: int = 20, shift: int = 0) -> Mission:
    waypoints = (
        Item(16, 3, x=473_977_420 + 900 * n + shift, y=85_455_940 + 700 * n, z=15.0 + n % 7)
        for n in range(items - 3)
    )
    return Mission((Item(16, 0, x=1), Item(22, 3, z=10.0), *waypoints, Item(20, 2)))


def fleet(count: int = 1, **settings) -> Rehearsal:
    vehicles = {f"uav{n}": Vehicle(VehicleConfig(sysid=n)) for n in range(1, count + 1)}
    return Rehearsal(vehicles, **settings)


def stored_positions(vehicle: Vehicle) -> list[tuple[int, int, int]]:
    return [(item.command, item.x, item.y) for item in vehicle.store.mission[1:]]


def wanted_positions(sent: Mission) -> list[tuple[int, int, int]]:
    return [(item.command, item.x, item.y) for item in sent.items[1:]]


@pytest.mark.parametrize("loss", [0.0, 0.1, 0.3])
def test_a_fleet_gets_its_missions_over_any_link(loss):
    """Three vehicles at once; what is proven delivered is what each really holds."""
    runner = fleet(3, to_vehicle=LinkFaults(loss=loss), from_vehicle=LinkFaults(loss=loss), seed=3)
    runner.advance(3.0)
    missions = {f"uav{n}": mission(20 + n, shift=n) for n in (1, 2, 3)}
    release = deliver_to_fleet(runner, missions).release()
    for uav, sent in missions.items():
        assert stored_positions(runner.vehicles[uav]) == wanted_positions(sent)
    assert len(set(release.digests.values())) == 3


def test_duplicated_reordered_and_late_frames_do_no_harm():
    """A long way over several radios: copies, overtaking, 0.9 s delay."""
    rough = LinkFaults(loss=0.05, delay_s=0.5, jitter_s=0.4, duplication=0.2, reordering=0.2)
    runner = fleet(1, to_vehicle=rough, from_vehicle=rough, seed=5)
    runner.advance(5.0)
    sent = mission(25)
    assert deliver_to_fleet(runner, {"uav1": sent}).release()
    assert stored_positions(runner.vehicles["uav1"]) == wanted_positions(sent)


def test_fence_and_rally_points_ride_along():
    """All three lists are on board afterwards; parameters wait for the start of the flight."""
    sent = dataclasses.replace(
        mission(),
        fence=fence_items(Fence(circles=(Circle((47.3977, 8.5456), 300.0),))),
        rally=rally_items((RallyPoint((47.3978, 8.5457), 30.0),)),
        parameters=(("FENCE_ALT_MAX", 120.0),),
    )
    runner = fleet()
    runner.advance(2.0)
    assert deliver_to_fleet(runner, {"uav1": sent}).release()
    store = runner.vehicles["uav1"].store
    assert [store.count(kind) for kind in (0, 1, 2)] == [20, 1, 1]
    assert runner.vehicles["uav1"].params["FENCE_ALT_MAX"] == 100.0
    assert deliver_to_fleet(runner, {"uav1": mission(30)}).release()
    assert [store.count(kind) for kind in (0, 1, 2)] == [30, 1, 1], "the fence must stay"


def test_one_refusal_keeps_the_whole_fleet_on_the_ground():
    """The refused vehicle is cleared and named; no vehicle is released."""
    runner = fleet(2)
    runner.advance(2.0)
    bad = mission()
    bad = Mission((*bad.items[:5], Item(31_000, 3), *bad.items[6:]))
    outcome = deliver_to_fleet(runner, {"uav1": mission(), "uav2": bad})
    assert set(outcome.delivered) == {"uav1"}
    with pytest.raises(FlightError, match="uav2: mission upload refused: UNSUPPORTED at item 5"):
        outcome.release()
    assert "cleared" in str(outcome.failed["uav2"])
    assert runner.vehicles["uav2"].store.count(MISSION) == 0


def test_missions_and_roster_must_name_the_same_vehicles():
    """A vehicle left out of an upload would keep its old mission unnoticed."""
    runner = fleet(2)
    with pytest.raises(RosterError, match="uav2"):
        deliver_to_fleet(runner, {"uav1": mission()})


def test_a_reboot_in_mid_upload_ends_in_a_verified_mission():
    """The half mission in the vehicle's storage is replaced in full."""
    runner = fleet()
    runner.advance(2.0)
    vehicle = runner.vehicles["uav1"]
    activity = runner.start("uav1", lambda context: deliver(context, mission(60)))
    assert runner.until(lambda: vehicle.store.count(MISSION) == 30, 10.0)
    vehicle.reboot()
    assert runner.until(lambda: activity.done, 60.0)
    assert activity.error is None
    assert stored_positions(vehicle) == wanted_positions(mission(60))
    runner.advance(2.0)
    assert runner.station.vehicle("uav1").reboots == 1


def test_streams_are_asked_for_again_after_a_reboot():
    """Settings do not survive a restart of the vehicle."""
    runner = fleet()
    runner.advance(5.0)
    state = runner.station.vehicle("uav1")
    runner.vehicles["uav1"].reboot()
    runner.advance(6.0)
    assert state.reboots == 1
    assert state.position_s > runner.now_s - 0.3


def test_lost_stream_requests_are_repeated_until_all_streams_flow():
    """An acknowledgement proves little on a lossy link; only the stream itself does."""
    half = LinkFaults(loss=0.5)
    runner = fleet(1, to_vehicle=half, from_vehicle=half, seed=11)
    runner.advance(60.0)
    seen = runner.station.vehicle("uav1").seen_s
    for message_id in (33, 30, 1, 24, 193, 42, 245, 2):
        assert seen[message_id] > runner.now_s - 6.0, message_id


def test_a_station_killed_in_mid_upload_leaves_a_state_the_next_one_mends():
    """Half a mission stays on board; a new station waits out the open upload and replaces it."""
    runner = fleet()
    runner.advance(2.0)
    vehicle = runner.vehicles["uav1"]
    runner.start("uav1", lambda context: deliver(context, mission(60)))
    assert runner.until(lambda: vehicle.store.count(MISSION) == 30, 10.0)
    again = Rehearsal({"uav1": vehicle}, station=Station(255, 192))
    again.advance(1.0)
    sent = mission(40, shift=7)
    reports = []
    outcome = deliver_to_fleet(again, {"uav1": sent}, lambda _uav, r: reports.append(r.text))
    assert outcome.release()
    assert stored_positions(vehicle) == wanted_positions(sent)
    assert any("another station" in text for text in reports)


def test_the_same_station_restarted_takes_its_upload_over_at_once():
    """A second MISSION_COUNT from the same system and component starts over."""
    runner = fleet()
    runner.advance(2.0)
    vehicle = runner.vehicles["uav1"]
    runner.start("uav1", lambda context: upload(context, mission(60).items))
    assert runner.until(lambda: vehicle.store.count(MISSION) == 30, 10.0)
    again = Rehearsal({"uav1": vehicle})
    again.advance(1.0)
    begun_s = again.now_s
    assert deliver_to_fleet(again, {"uav1": mission(40)}).release()
    assert again.now_s - begun_s < 2.0


def test_two_stations_upload_in_turn():
    """The second one waits; in the end the vehicle holds the mission of the last to finish."""
    runner = fleet()
    runner.advance(2.0)
    runner.station.submit(
        "uav1", lambda context: upload(context, mission(100).items), lambda _: None
    )
    other = mavlink.MAVLink(None, 254, 190)
    count = mavlink.MAVLink_mission_count_message(1, 1, 5, 0).pack(other)
    runner.advance(0.1)
    vehicle = runner.vehicles["uav1"]
    vehicle.handle(count, 1)
    runner.advance(3.0)
    assert stored_positions(vehicle) == wanted_positions(mission(100))


def test_foreign_vehicles_are_counted_and_ignored():
    """A system id that the roster does not name changes nothing."""
    runner = fleet()
    stranger = Vehicle(VehicleConfig(sysid=9))
    runner.air.vehicles[9] = stranger
    runner.air.up[9] = type(runner.air.up[1])(CLEAN, 1)
    runner.air.down[9] = type(runner.air.up[1])(CLEAN, 2)
    runner.advance(5.0)
    assert runner.station.foreign[str(runner.roster.links[0]), 9] >= 4
    assert set(runner.station.tracks) == {"uav1"}
    with pytest.raises(RosterError, match="uav9"):
        runner.station.vehicle("uav9")


def test_two_vehicles_with_one_system_id_are_refused_by_name():
    """Merged silently by other stations; here nothing is sent to either."""
    runner = fleet()
    runner.air.vehicles[101] = Vehicle(VehicleConfig(sysid=1, uid2=tuple(range(1, 19))))
    runner.air.up[101] = type(runner.air.up[1])(CLEAN, 1)
    runner.air.down[101] = type(runner.air.up[1])(CLEAN, 2)
    runner.advance(15.0)
    with pytest.raises(RosterError, match="uav1: two vehicles answer to system id 1"):
        runner.station.check_identity("uav1")
    outcome = deliver_to_fleet(runner, {"uav1": mission()})
    assert isinstance(outcome.failed["uav1"], RosterError)
    assert all(v.store.count(MISSION) == 0 for v in runner.air.vehicles.values())


def signed_fleet(**settings) -> Rehearsal:
    """One vehicle that holds the test key, spoken to on its second port."""
    runner = fleet(1, port=1, **settings)
    vehicle = runner.vehicles["uav1"]
    vehicle.key.secret = KEY
    return runner


def test_a_signed_fleet_is_worked_with_and_forgeries_are_counted():
    """Uploads work over a lossy signed link, every retry signed anew."""
    loss = LinkFaults(loss=0.2)
    unix = VehicleConfig().utc_at_boot_us / 1e6
    signer = Signer(KEY, lambda: unix)
    runner = signed_fleet(signer=signer, to_vehicle=loss, from_vehicle=loss)
    runner.advance(3.0)
    assert deliver_to_fleet(runner, {"uav1": mission()}).release()
    assert signer.counters.good > 50
    assert signer.counters.refused == 0
    heard = runner.link.counters.frames_in
    codec = mavlink.MAVLink(None, 1, 1)
    forged = mavlink.MAVLink_heartbeat_message(2, 3, 209, 3, 4, 3).pack(codec)
    runner.air.down[1].put(forged, runner.now_s)
    runner.advance(0.005)
    assert signer.counters.unsigned == 1
    assert not runner.station.vehicle("uav1").armed
    assert heard > 0


def test_an_unsigned_station_meets_silence_on_a_signed_vehicle():
    """No answer at all: said as such after half a minute, nothing changed on board."""
    runner = signed_fleet()
    runner.advance(3.0)
    outcome = deliver_to_fleet(runner, {"uav1": mission()})
    error = outcome.failed["uav1"]
    assert isinstance(error, TransferError)
    assert error.code == 403
    assert runner.vehicles["uav1"].store.count(MISSION) == 0


def test_parameters_are_proven_taken():
    """Set, seen back, read; an unknown name gets no answer and says so."""
    runner = fleet(1, to_vehicle=LinkFaults(loss=0.2), from_vehicle=LinkFaults(loss=0.2))
    runner.advance(2.0)
    jobs = {"uav1": lambda context: set_parameter(context, "WPNAV_SPEED", 555.0)}
    assert runner.run(jobs) == {"uav1": None}
    assert runner.run({"uav1": lambda c: read_parameter(c, "WPNAV_SPEED")}) == {"uav1": 555.0}
    error = runner.run({"uav1": lambda c: read_parameter(c, "NO_SUCH_THING")})["uav1"]
    assert isinstance(error, CommandError)
    assert error.code == 506


def test_verify_and_clear_tell_the_truth():
    """A changed item is found; after a clear nothing is left."""
    runner = fleet()
    runner.advance(2.0)
    deliver_to_fleet(runner, {"uav1": mission()}).release()
    assert runner.run({"uav1": lambda c: verify(c, mission())}) == {"uav1": ()}
    found = runner.run({"uav1": lambda c: verify(c, mission(shift=1))})["uav1"]
    assert len(found) == 17
    assert runner.run({"uav1": lambda c: clear(c, MISSION)}) == {"uav1": None}
    assert len(runner.run({"uav1": download})["uav1"]) <= 1


def test_the_clock_of_a_vehicle_is_measured():
    """Offset, round trip and UTC error of a link with 40 ms each way."""
    slow = LinkFaults(delay_s=0.04)
    runner = fleet(1, to_vehicle=slow, from_vehicle=slow)
    runner.advance(45.0)
    sync = runner.station.vehicle("uav1").time_sync
    assert sync.round_trip.smoothed_s == pytest.approx(0.085, abs=0.01)
    assert abs(sync.offset_s) < 0.01
    assert abs(sync.utc_error_s) < 0.02


def test_a_vehicle_is_given_its_key_and_proves_it_without_the_key_in_the_log():
    """From then on it signs; the log of the link holds everything but the key."""
    logged = bytearray()
    runner = fleet(log=lambda _uav, raw: logged.extend(raw))
    runner.advance(3.0)
    unix = VehicleConfig().utc_at_boot_us / 1e6
    signer = Signer(KEY, lambda: unix + runner.now_s)
    assert runner.run({"uav1": lambda context: setup_signing(context, signer)}) == {"uav1": None}
    assert runner.vehicles["uav1"].key.secret == KEY
    assert len(logged) > 1000
    assert KEY not in bytes(logged)


def test_a_vehicle_that_does_not_take_its_key_is_named():
    """Its link cut one way, it never signs."""
    runner = fleet()
    runner.advance(3.0)
    runner.air.set_faults(1, LinkFaults(cut=True), CLEAN)
    signer = Signer(KEY, lambda: VehicleConfig().utc_at_boot_us / 1e6)
    error = runner.run({"uav1": lambda context: setup_signing(context, signer)})["uav1"]
    assert isinstance(error, SigningError)
    assert "uav1: does not sign" in str(error)


def test_nonsense_in_good_frames_does_no_harm():
    """10 000 frames of every message type with random payloads and right checksums, during work."""
    runner = fleet()
    runner.advance(3.0)
    rng = random.Random(4)
    kinds = [(number, kind) for number, kind in mavlink.mavlink_map.items()]
    upload_under_way = runner.start("uav1", lambda context: deliver(context, mission(60)))
    for n in range(10_000):
        number, kind = rng.choice(kinds)
        size = kind.unpacker.size
        header = bytes((0xFD, size, 0, 0, n % 256, 1, 1)) + number.to_bytes(3, "little")
        body = header + (rng.randbytes(size) if rng.random() < 0.7 else b"\xff" * size)
        checksum = mavlink.x25crc(bytearray(body[1:]) + bytes((kind.crc_extra,))).crc
        runner.air.down[1].put(body + checksum.to_bytes(2, "little"), runner.now_s)
        if n % 20 == 0:
            runner.advance(0.005)
    assert runner.link.counters.frames_in > 9_000
    state = runner.station.vehicle("uav1")
    assert len(state.texts) <= 200
    assert len(state.seen_s) <= len(kinds)
    runner.until(lambda: upload_under_way.done, 400.0)
    assert upload_under_way.done
    held = runner.vehicles["uav1"]
    if upload_under_way.error is None:
        assert stored_positions(held) == wanted_positions(mission(60))
    else:
        assert isinstance(upload_under_way.error, TransferError)
    runner.advance(20.0)
    assert runner.station.vehicle("uav1").mode == 0
