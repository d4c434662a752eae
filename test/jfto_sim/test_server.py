"""Vehicles on real sockets: UDP, TCP, several at once, faults on command."""

import select
import socket
import time
from dataclasses import replace

import pytest

from jfto_msgs_py.errors import InputError
from jfto_sim import VehicleConfig
from jfto_sim.config import fleet
from jfto_sim.dialect import mavlink as m
from jfto_sim.endpoint import open_endpoint
from jfto_sim.server import ServerSettings, SimServer, default_endpoints

PATIENCE_S = 20.0
UDP = ("udp:127.0.0.1:0",)
BOTH = ("tcp:127.0.0.1:0", "udp:127.0.0.1:0")


class Client:
    """A bare station on a socket."""

    def __init__(self, address, kind=socket.SOCK_DGRAM):
        self.socket = socket.socket(socket.AF_INET, kind)
        self.socket.connect(address)
        self.codec = m.MAVLink(None, 255, 190)
        self.codec.robust_parsing = True

    def send(self, message):
        self.socket.send(message.pack(self.codec))

    def wait(self, kind, system=None):
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            ready, _, _ = select.select([self.socket], [], [], end - time.monotonic())
            data = self.socket.recv(4096) if ready else b""
            for message in self.codec.parse_buffer(data) or []:
                if message.get_type() == kind and system in (None, message.get_srcSystem()):
                    return message
        raise AssertionError(f"no {kind} was heard")

    def close(self):
        self.socket.close()


@pytest.fixture
def clients():
    opened = []

    def connect(address, kind=socket.SOCK_DGRAM):
        opened.append(Client(address, kind))
        return opened[-1]

    yield connect
    for client in opened:
        client.close()


def until(condition):
    end = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < end


def heartbeat():
    return m.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3)


def ask_version(system):
    return m.MAVLink_command_long_message(system, 1, 512, 0, 148, 0, 0, 0, 0, 0, 0)


def test_udp_and_tcp_ports_of_one_vehicle(clients):
    """Both endpoints answer; TCP is the first port."""
    with SimServer([VehicleConfig()], ServerSettings((BOTH,), speedup=10)) as server:
        tcp, udp = server.addresses(1)
        for client in (clients(tcp, socket.SOCK_STREAM), clients(udp)):
            client.send(ask_version(1))
            assert client.wait("AUTOPILOT_VERSION").flight_sw_version == 0x040505FF


def test_three_vehicles_in_one_process(clients):
    """Each is heard under its own system id, on its own port."""
    with SimServer(fleet(3), ServerSettings((UDP,) * 3, speedup=5)) as server:
        for sysid in (1, 2, 3):
            client = clients(server.addresses(sysid)[0])
            client.send(heartbeat())
            assert client.wait("HEARTBEAT").get_srcSystem() == sysid


def test_several_vehicles_on_one_station_socket(clients):
    """With udpto all vehicles send to the one address of a listening station."""
    station = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    station.bind(("127.0.0.1", 0))
    station.settimeout(PATIENCE_S)
    spec = (f"udpto:127.0.0.1:{station.getsockname()[1]}",)
    codec, heard = m.MAVLink(None), set()
    with SimServer(fleet(3), ServerSettings((spec,) * 3, speedup=10)):
        while heard != {1, 2, 3}:
            heard |= {x.get_srcSystem() for x in codec.parse_buffer(station.recv(4096)) or []}
    station.close()


def test_a_pace_holds_the_vehicles_back_and_lets_them_go():
    """However fast they are to be, their time goes no further than it is granted."""
    limit_s = [2.0]

    def pace(server, _passed_s):
        return max(limit_s[0] - server.elapsed_s, 0.0)

    with SimServer(fleet(2), ServerSettings((UDP,) * 2, speedup=20), pace=pace) as server:
        for limit in (2.0, 4.0):
            limit_s[0] = limit
            until(lambda limit=limit: server.elapsed_s > limit - 1e-6)
            assert server.elapsed_s < limit + 1e-6


@pytest.mark.parametrize("endpoint", [0, 1])
def test_it_knows_the_newest_position_that_a_vehicle_has_sent(clients, endpoint):
    """By the vehicle's UTC, in MAVLink 1 and 2, and not before somebody asked for it."""
    with SimServer([VehicleConfig()], ServerSettings((BOTH,), speedup=10)) as server:
        kind = socket.SOCK_STREAM if endpoint == 0 else socket.SOCK_DGRAM
        client = clients(server.addresses(1)[endpoint], kind)
        client.send(heartbeat())
        client.wait("HEARTBEAT")
        assert server.stations[1].position_ns == 0
        client.send(m.MAVLink_command_long_message(1, 1, 511, 0, 33, 2e5, 0, 0, 0, 0, 0))
        at_ms = client.wait("GLOBAL_POSITION_INT").time_boot_ms
        at_ns = (VehicleConfig().utc_at_boot_us + 1000 * at_ms) * 1000
        until(lambda: server.stations[1].position_ns >= at_ns)
        assert (server.stations[1].position_ns - at_ns) % 1_000_000 == 0


def test_second_tcp_client_hears_nothing(clients):
    """As in ArduPilot's simulation, a TCP port serves one client."""
    with SimServer([VehicleConfig()], ServerSettings((BOTH,), speedup=10)) as server:
        address = server.addresses(1)[0]
        first = clients(address, socket.SOCK_STREAM)
        first.wait("HEARTBEAT")
        second = clients(address, socket.SOCK_STREAM)
        first.wait("HEARTBEAT")
        first.wait("HEARTBEAT")
        assert not select.select([second.socket], [], [], 0)[0]


def test_reboot_ends_the_connection_and_the_vehicle_comes_back(clients):
    """After a reboot TCP has to be connected anew."""
    with SimServer([VehicleConfig()], ServerSettings((BOTH,), speedup=10)) as server:
        client = clients(server.addresses(1)[0], socket.SOCK_STREAM)
        client.wait("HEARTBEAT")
        server.fault("reboot 1")
        client.socket.settimeout(PATIENCE_S)
        while client.socket.recv(4096):
            pass
        again = clients(server.addresses(1)[0], socket.SOCK_STREAM)
        assert again.wait("HEARTBEAT").get_srcSystem() == 1


def test_fault_lines_over_the_control_socket():
    """A line is carried out and answered; a wrong one is explained."""
    settings = ServerSettings((UDP,), control_port=0)
    with SimServer([VehicleConfig()], settings) as server:
        control = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        control.settimeout(PATIENCE_S)
        control.connect(server.control_address)
        control.send(b"gps 1 off")
        assert control.recv(512) == b"ok"
        control.send(b"gps 9 off")
        assert control.recv(512).startswith(b"error: There is no vehicle 9")
        control.close()
        params = server.stations[1].vehicle.params
        assert server.call(lambda: params["SIM_GPS_DISABLE"]) == 1


def test_cut_link_is_silent(clients):
    """A cut from the start lets nothing through; mended, the vehicle is heard."""
    settings = ServerSettings((UDP,), speedup=10, faults=("link 1 cut=1",))
    with SimServer([VehicleConfig()], settings) as server:
        client = clients(server.addresses(1)[0])
        client.send(heartbeat())
        pipes = server.stations[1].links[0]
        end = time.monotonic() + PATIENCE_S
        while not server.call(lambda: pipes["to"].lost) and time.monotonic() < end:
            pass
        assert server.call(lambda: pipes["to"].lost) == 1
        assert not select.select([client.socket], [], [], 0)[0]
        server.fault("mend 1")
        client.send(heartbeat())
        client.wait("HEARTBEAT")


@pytest.mark.parametrize("text", ["tcp:127.0.0.1", "serial:a:1", "udp:127.0.0.1:x"])
def test_wrong_endpoints_are_refused(text):
    """An endpoint is kind:host:port."""
    with pytest.raises(InputError):
        open_endpoint(text)


def test_two_vehicles_with_one_system_id_on_a_shared_link_both_obey(clients):
    """As on a radio net: one command, two acknowledgements, and two positions under one id."""
    shared = ("shared:udp:127.0.0.1:0",)
    configs = [replace(c, sysid=1, uid2=tuple(c.identity)) for c in fleet(2, spacing_m=50.0)]
    with SimServer(configs, ServerSettings((shared,) * 2, speedup=10)) as server:
        assert server.addresses(1) == server.addresses(2)
        client = clients(server.addresses(1)[0])
        client.send(ask_version(1))
        identities = {tuple(client.wait("AUTOPILOT_VERSION").uid2) for _ in range(2)}
        assert identities == {tuple(config.identity) for config in configs}
        client.send(m.MAVLink_command_long_message(1, 1, 176, 0, 1, 9, 0, 0, 0, 0, 0))
        until(lambda: all(s.vehicle.mode.number == 9 for s in server.stations.values()))


def test_wrong_settings_are_refused():
    """No endpoints, a taken port, a negative speed-up."""
    with pytest.raises(InputError, match="endpoints for 1"):
        SimServer(fleet(2), ServerSettings((UDP,)))
    with pytest.raises(InputError, match="speedup"):
        SimServer(fleet(1), ServerSettings((UDP,), speedup=-1))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        spec = f"udp:127.0.0.1:{taken.getsockname()[1]}"
        with pytest.raises(InputError, match="Choose another port"):
            SimServer(fleet(1), ServerSettings(((spec,),)))
    with pytest.raises(InputError, match="ports"):
        SimServer(fleet(1), ServerSettings((UDP * 4,)))


def test_default_endpoints_do_not_collide():
    """Every vehicle has a TCP and a UDP port of its own."""
    endpoints = [text for texts in default_endpoints(30) for text in texts]
    assert len(set(endpoints)) == 60


@pytest.mark.parametrize("bad", [{"count": 0}, {"count": 201}, {"count": 2, "spacing_m": -1}])
def test_impossible_fleets_are_refused(bad):
    """Counts and spacings are checked."""
    with pytest.raises(InputError):
        fleet(**bad)
