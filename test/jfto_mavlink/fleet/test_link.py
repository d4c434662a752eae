"""The bridge over real sockets and lines, with simulated vehicles at the other end."""

from __future__ import annotations

import os
import random
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable

import pytest

from jfto_mavlink.errors import LinkError, RosterError
from jfto_mavlink.files.tlog import read_tlog
from jfto_mavlink.fleet.fly import deliver_to_fleet
from jfto_mavlink.fleet.link import FleetLink
from jfto_mavlink.fleet.roster import Roster, parse_roster
from jfto_mavlink.fleet.station import StationSettings
from jfto_mavlink.flight.control import brake
from jfto_mavlink.io.address import free_udp_port, parse_address
from jfto_mavlink.io.port import Station, open_transport
from jfto_mavlink.mission.deliver import deliver
from jfto_mavlink.protocol.item import MISSION, Item, Mission
from jfto_mavlink.protocol.timesync import ScaledClock
from jfto_sim import VehicleConfig
from jfto_sim.server import ServerSettings, SimServer

SPEEDUP = 10.0


def serve(*endpoints: str) -> SimServer:
    """Vehicles 1, 2, … with one endpoint each, ten times faster than the clock."""
    configs = [VehicleConfig(sysid=n) for n in range(1, len(endpoints) + 1)]
    return SimServer(configs, ServerSettings(tuple((e,) for e in endpoints), SPEEDUP))


def mission(items: int = 20, shift: int = 0) -> Mission:
    waypoints = (Item(16, 3, x=473_977_420 + 90 * n + shift, y=1, z=15.0) for n in range(items - 3))
    return Mission((Item(16, 0, x=1), Item(22, 3, z=10.0), *waypoints, Item(20, 2)))


def wait(condition: Callable[[], bool], seconds: float = 60.0) -> bool:
    """Poll until a condition holds, at most that long on the wall."""
    pause = threading.Event()
    for _ in range(int(seconds / 0.01)):
        if condition():
            return True
        pause.wait(0.01)
    return False


def held(server: SimServer, sysid: int) -> list[int]:
    return [item.x for item in server.stations[sysid].vehicle.store.mission[2:-1]]


def test_three_vehicles_on_one_listening_port(tmp_path):
    """Each is answered at its own address; logs are written per vehicle, both directions."""
    port = free_udp_port()
    roster = parse_roster([f"uav{n}={n}@udpin:127.0.0.1:{port}" for n in (1, 2, 3)])
    with (
        serve(*[f"udpto:127.0.0.1:{port}"] * 3) as server,
        FleetLink(
            roster, StationSettings(log_directory=tmp_path), clock=ScaledClock(SPEEDUP)
        ) as bridge,
    ):
        bridge.wait_heard(60.0)
        missions = {f"uav{n}": mission(shift=n) for n in (1, 2, 3)}
        assert deliver_to_fleet(bridge, missions).release()
        for n in (1, 2, 3):
            assert held(server, n) == [item.x for item in mission(shift=n).items[2:-1]]
        assert wait(lambda: bridge.vehicle("uav2").position_s is not None)
    for n in (1, 2, 3):
        systems = {raw[5] for _, raw in read_tlog(tmp_path / f"uav{n}.tlog")}
        assert systems == {n, 255}


def test_tcp_links_come_back_after_a_vehicle_reboot():
    """One TCP connection per vehicle, as ArduPilot's simulation offers; a reboot ends it."""
    with serve("tcp:127.0.0.1:0", "tcp:127.0.0.1:0") as server:
        ports = [server.addresses(n)[0][1] for n in (1, 2)]
        roster = parse_roster([f"uav{n}={n}@tcp:127.0.0.1:{p}" for n, p in enumerate(ports, 1)])
        with FleetLink(roster, clock=ScaledClock(SPEEDUP)) as bridge:
            bridge.wait_heard(100.0)
            assert wait(lambda: bridge.vehicle("uav1").time_sync.samples > 4)
            server.fault("reboot 1")
            assert wait(lambda: bridge.vehicle("uav1").reboots == 1)
            assert bridge.vehicle("uav2").reboots == 0
            missions = {"uav1": mission(), "uav2": mission(shift=5)}
            assert deliver_to_fleet(bridge, missions).release()
            assert held(server, 1) == [item.x for item in mission().items[2:-1]]


def test_udpout_speaks_first():
    """A vehicle that listens learns our address from our heartbeat."""
    with serve("udp:127.0.0.1:0") as server:
        port = server.addresses(1)[0][1]
        with FleetLink(
            parse_roster([f"uav1=1@udpout:127.0.0.1:{port}"]), clock=ScaledClock(SPEEDUP)
        ) as bridge:
            bridge.wait_heard(60.0)
            assert bridge.run({"uav1": brake}) == {"uav1": None}
            assert bridge.vehicle("uav1").mode_name == "BRAKE"


def test_a_log_that_cannot_be_written_ends_and_the_bridge_goes_on(tmp_path):
    """The disk is full: told once, and the vehicle is still heard."""
    told = []
    with (
        serve("udp:127.0.0.1:0") as server,
        FleetLink(
            parse_roster([f"uav1=1@udpout:127.0.0.1:{server.addresses(1)[0][1]}"]),
            StationSettings(log_directory=tmp_path),
            clock=ScaledClock(SPEEDUP),
            on_event=told.append,
        ) as bridge,
    ):
        bridge.wait_heard(60.0)
        full = os.open("/dev/full", os.O_WRONLY)
        os.dup2(full, bridge._logs["uav1"]._fd)
        os.close(full)
        assert wait(lambda: any(event.kind == "log" for event in told))
        assert bridge.run({"uav1": brake}) == {"uav1": None}
    (text,) = [event.text for event in told if event.kind == "log"]
    assert "No space left" in text


def test_a_serial_line_carries_frames_both_ways():
    """Over a pseudo-terminal; unplugged, the link is down and says nothing."""
    master, slave = os.openpty()
    link = open_transport(parse_address(f"serial:{os.ttyname(slave)}:115200"))
    try:
        link.maintain(0.0)
        assert link.fileno() is not None
        link.send(b"\xfdhello", None)
        assert os.read(master, 100) == b"\xfdhello"
        os.write(master, b"\xfdworld")
        assert wait(lambda: link.receive() == [(None, b"\xfdworld")])
    finally:
        os.close(master)
        os.close(slave)
    assert wait(lambda: link.receive() == [] and link.fileno() is None)
    link.send(b"lost", None)
    assert link.dropped == 1
    link.close()


def test_a_vehicle_that_is_not_there_is_named():
    """With the ones that were heard instead."""
    port = free_udp_port()
    roster = parse_roster([f"uav{n}={n}@udpin:127.0.0.1:{port}" for n in (1, 7)])
    with (
        serve(*[f"udpto:127.0.0.1:{port}"] * 2),
        FleetLink(roster, clock=ScaledClock(SPEEDUP)) as bridge,
    ):
        assert wait(lambda: 2 in {system for _, system in list(bridge.station.foreign)})
        assert wait(lambda: bridge.station.tracks["uav1"].identity.known)
        with pytest.raises(RosterError, match=r"uav7 not heard.*\[2\]"):
            bridge.wait_heard(5.0)


def test_a_taken_port_is_an_error_at_once():
    """Two programs cannot listen on one port."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
        with pytest.raises(LinkError, match=f"{port}: cannot be opened"):
            FleetLink(parse_roster([f"a=1@udpin:127.0.0.1:{port}"]))


def test_closing_ends_whoever_waits():
    """A conversation under way ends with an error, not in a hang."""
    bridge = FleetLink(
        Roster(parse_roster(["a=1@udpin:127.0.0.1:" + str(free_udp_port())]).entries)
    )
    with bridge:
        future = bridge.start("a", brake)
    with pytest.raises(LinkError, match="closed"):
        future.result(timeout=10)


def test_floods_of_rubbish_leave_the_bridge_working():
    """10 000 malformed frames and random datagrams from many senders: no crash, no growth."""
    port, rng = free_udp_port(), random.Random(3)
    roster = parse_roster([f"uav1=1@udpin:127.0.0.1:{port}"])
    with (
        serve(f"udpto:127.0.0.1:{port}"),
        FleetLink(roster, clock=ScaledClock(SPEEDUP)) as bridge,
    ):
        bridge.wait_heard(60.0)
        counters = bridge.ports[0].counters
        good = bytes.fromhex("fd09000000010100000000000000020351040 3e71e".replace(" ", ""))
        senders = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(100)]
        for n in range(10_000):
            raw = bytearray(good if n % 2 else rng.randbytes(rng.randint(1, 290)))
            raw[rng.randrange(len(raw))] ^= 1 << rng.randrange(8)
            senders[n % 100].sendto(raw, ("127.0.0.1", port))
            if n % 200 == 0:
                assert wait(lambda: bridge.vehicle("uav1").silent_s(bridge.clock()) < 5.0)
        for sender in senders:
            sender.close()
        assert counters.bytes_in > 100_000
        assert len(bridge.ports[0]._framers) <= 64
        assert len(bridge.station.foreign) <= 256
        assert deliver_to_fleet(bridge, {"uav1": mission()}).release()


def test_two_stations_do_not_fight_over_a_vehicle():
    """Both upload at once on two ports: one mission stays, proven by its station."""
    configs = [VehicleConfig(sysid=1)]
    settings = ServerSettings((("udp:127.0.0.1:0", "udp:127.0.0.1:0"),), SPEEDUP)
    with SimServer(configs, settings) as server:
        first, second = (f"uav1=1@udpout:127.0.0.1:{p}" for _, p in server.addresses(1))
        store = server.stations[1].vehicle.store
        with (
            FleetLink(parse_roster([first]), clock=ScaledClock(SPEEDUP)) as a,
            FleetLink(
                parse_roster([second]),
                StationSettings(Station(254, 191)),
                clock=ScaledClock(SPEEDUP),
            ) as b,
        ):
            a.wait_heard(60.0)
            b.wait_heard(60.0)
            long, short = mission(500, shift=3), mission(20, shift=4)
            begun = a.start("uav1", lambda context: deliver(context, long))
            assert wait(lambda: store.count(MISSION) > 50)
            other = b.start("uav1", lambda context: deliver(context, short))
            endings = [begun.exception(120.0), other.exception(120.0)]
        on_board = held(server, 1)
    proven = {
        tuple(item.x for item in sent.items[2:-1])
        for sent, error in zip((long, short), endings, strict=True)
        if error is None
    }
    assert all(error is None or error.code == 402 for error in endings)
    assert tuple(on_board) in proven


STATION = """
import sys
from jfto_mavlink.fleet.link import FleetLink
from jfto_mavlink.fleet.station import StationSettings
from jfto_mavlink.protocol.timesync import ScaledClock
from jfto_mavlink.mission.deliver import deliver
from jfto_mavlink.protocol.item import Item, Mission
from jfto_mavlink.fleet.roster import parse_roster
items = [Item(16, 0, x=1), Item(22, 3, z=10.0)] + [Item(16, 3, x=7, y=n) for n in range(600)]
with FleetLink(parse_roster([sys.argv[1]]), clock=ScaledClock(10.0)) as bridge:
    bridge.wait_heard(100.0)
    bridge.run({"uav1": lambda context: deliver(context, Mission(tuple(items)))})
"""


def test_a_station_killed_in_mid_upload_is_replaced_by_the_next():
    """Kill -9 while items travel; started again it replaces the half mission and proves it."""
    with serve("udp:127.0.0.1:0") as server:
        entry = f"uav1=1@udpout:127.0.0.1:{server.addresses(1)[0][1]}"
        store = server.stations[1].vehicle.store
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
        process = subprocess.Popen([sys.executable, "-c", STATION, entry], env=environment)
        assert wait(lambda: store.count(MISSION) > 50, 60.0)
        process.send_signal(signal.SIGKILL)
        assert process.wait() == -signal.SIGKILL
        assert store.count(MISSION) < 602
        with FleetLink(parse_roster([entry]), clock=ScaledClock(SPEEDUP)) as bridge:
            bridge.wait_heard(60.0)
            assert deliver_to_fleet(bridge, {"uav1": mission()}).release()
        assert held(server, 1) == [item.x for item in mission().items[2:-1]]
