"""jfto mission, on files and on simulated vehicles."""

from __future__ import annotations

import json
import socket
from pathlib import Path

import pytest

from jfto.cli import main
from jfto_mavlink.files import read_mission
from jfto_sim import VehicleConfig
from jfto_sim.server import ServerSettings, SimServer


@pytest.fixture
def plan(tiny_run) -> Path:
    """The tiny scene's plan, its scenario beside it."""
    return tiny_run[0] / "plan.json"


@pytest.fixture
def vehicles():
    """Four simulated vehicles that speak to one port, and the roster of them."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    configs = [VehicleConfig(sysid=n) for n in range(1, 5)]
    settings = ServerSettings(((f"udpto:127.0.0.1:{port}",),) * 4)
    roster = ",".join(f"uav{n}={n}@udpin:127.0.0.1:{port}" for n in range(1, 5))
    with SimServer(configs, settings) as server:
        yield server, roster


@pytest.mark.parametrize("form", ["plan", "waypoints"])
def test_missions_are_exported_for_other_stations(plan, tmp_path, capsys, form):
    """One file per UAV, readable again, with its hash on the screen."""
    assert main(["mission", "export", str(plan), "-o", str(tmp_path), "--format", form]) == 0
    files = sorted(tmp_path.glob(f"uav?.{form}"))
    assert len(files) == 4
    assert all(len(read_mission(path).items) > 4 for path in files)
    assert capsys.readouterr().out.count("items") == 4


def test_a_mission_is_converted_and_compared(plan, tmp_path, capsys):
    """.plan to .waypoints and back: nothing differs but the parameters that WPL cannot hold."""
    assert main(["mission", "export", str(plan), "-o", str(tmp_path)]) == 0
    first, second = str(tmp_path / "uav1.plan"), str(tmp_path / "uav1.waypoints")
    assert main(["mission", "import", first, second]) == 0
    capsys.readouterr()
    assert main(["mission", "diff", first, second]) == 1
    *lost, verdict = capsys.readouterr().out.splitlines()
    assert verdict == "13 lines differ"
    assert "- WPNAV_RADIUS 120" in lost
    assert all(line.startswith("- ") for line in lost)
    assert main(["mission", "diff", first, first]) == 0
    assert main(["mission", "diff", first, str(tmp_path / "uav2.plan")]) == 1


def test_a_mission_that_is_out_of_bounds_is_not_imported(tmp_path, capsys):
    """The autopilot would store 500 m below home without a word."""
    path = tmp_path / "deep.waypoints"
    path.write_text(
        "QGC WPL 110\n0 1 0 16 0 0 0 0 47.4 8.5 488 1\n1 0 3 22 0 0 0 0 0 0 10 1\n"
        "2 0 3 16 0 0 0 0 47.4 8.5 -500 1\n"
    )
    assert main(["mission", "import", str(path)]) == 2
    assert "item 2: height -500.0 m" in capsys.readouterr().err


@pytest.mark.slow
def test_upload_verify_and_clear_go_together(plan, vehicles, tmp_path, capsys):
    """Uploaded it verifies; another way home is refused or differs; cleared it verifies no more."""
    server, roster = vehicles
    common = ["--vehicles", roster]
    assert main(["mission", "upload", str(plan), *common]) == 0
    assert "fleet released: 4 vehicles" in capsys.readouterr().out
    assert main(["mission", "verify", str(plan), *common]) == 0
    height = "mavlink_bridge.return_height_m=300"
    assert main(["mission", "verify", str(plan), *common, "--set", height]) == 2
    assert "way home is planned" in capsys.readouterr().err
    higher = json.loads(plan.read_text())
    for uav in higher["uavs"]:
        for point in uav["home"]["points_m"][1:]:
            point[2] += 10.0
    (tmp_path / "higher.json").write_text(json.dumps(higher))
    assert main(["mission", "verify", str(tmp_path / "higher.json"), *common]) == 1
    assert "differences" in capsys.readouterr().out
    assert main(["mission", "clear", *common, "--yes"]) == 0
    assert all(s.vehicle.store.count(0) == 0 for s in server.stations.values())
    assert main(["mission", "verify", str(plan), *common]) == 1
    assert "differences" in capsys.readouterr().out


@pytest.mark.slow
def test_a_link_names_the_whole_fleet_as_it_does_for_run(plan, vehicles, capsys):
    """System ids 1, 2 … in the order of the plan, all on that link."""
    _, roster = vehicles
    link = roster.rpartition("@")[2]
    assert main(["mission", "upload", str(plan), "--vehicles", link]) == 0
    assert "fleet released: 4 vehicles" in capsys.readouterr().out
    assert main(["mission", "verify", str(plan), "--vehicles", roster]) == 0


def test_parameters_of_an_upload_are_put_back_by_their_record(plan, vehicles, tmp_path, capsys):
    """Set with the missions, old values beside the plan; restored, the record is gone."""
    server, roster = vehicles
    copy = tmp_path / "plan.json"
    copy.write_bytes(plan.read_bytes())
    params = server.stations[1].vehicle.params
    assert main(["mission", "upload", str(copy), "--vehicles", roster]) == 0
    record = tmp_path / "parameters.json"
    assert str(record) in capsys.readouterr().out
    assert params["WPNAV_RADIUS"] == 120.0
    assert main(["mission", "restore", str(record), "--vehicles", roster]) == 0
    assert params["WPNAV_RADIUS"] == 200.0
    assert not record.exists()


def test_a_plan_is_held_against_vehicles_that_are_elsewhere(plan, vehicles, capsys):
    """FIELD 5, 15, 18: the forms of `run`; status 1, JSON, each reason in full, nothing is sent."""
    server, roster = vehicles
    link = roster.rpartition("@")[2]
    assert main(["preflight", str(plan), "--vehicles", link, "--json"]) == 1
    page = json.loads(capsys.readouterr().out)
    assert page["level"] == "red"
    assert [one["uav"] for one in page["vehicles"]] == ["uav1", "uav2", "uav3", "uav4"]
    pads = [f for one in page["vehicles"] for f in one["findings"] if f["topic"] == "pad"]
    assert all(found["text"] for found in pads)
    assert all(s.vehicle.store.count(0) == 0 for s in server.stations.values())


def test_a_vehicle_missing_from_the_roster_stops_everything(plan, vehicles, capsys):
    """Before anything is sent."""
    server, roster = vehicles
    three = roster.rpartition(",")[0]
    assert main(["mission", "upload", str(plan), "--vehicles", three]) == 2
    assert "uav4: in the fleet or in the roster, not in both" in capsys.readouterr().err
    assert all(s.vehicle.store.count(0) == 0 for s in server.stations.values())


def test_vehicles_are_given_a_signing_key(vehicles, tmp_path, capsys):
    """Their frames carry a good signature afterwards; the key is on no screen."""
    server, roster = vehicles
    key = tmp_path / "fleet.key"
    assert main(["mission", "sign", "--vehicles", roster, "--key", str(key), "--create"]) == 0
    assert key.stat().st_mode & 0o777 == 0o600
    secret = bytes.fromhex(key.read_text())
    assert all(s.vehicle.key.secret == secret for s in server.stations.values())
    printed = capsys.readouterr()
    assert secret.hex() not in printed.out + printed.err


@pytest.mark.parametrize(
    ("vehicles_text", "words"),
    [
        ("sim:3", "must be sim or sim:4"),
        ("uav1=1@udp:h:1", "must begin with one of"),
        ("uav1", "UAV=SYSID@LINK"),
    ],
)
def test_a_wrong_roster_is_explained(plan, capsys, vehicles_text, words):
    """Status 2 and one sentence."""
    assert main(["mission", "upload", str(plan), "--vehicles", vehicles_text]) == 2
    assert words in capsys.readouterr().err


@pytest.mark.slow
def test_orders_reach_the_vehicles_named_and_no_others(vehicles, capsys):
    """Seen to work, or said why not; a stranger in the list stops everything."""
    server, roster = vehicles
    common = ["--vehicles", roster]
    assert main(["mission", "order", "hold", *common, "--only", "uav2"]) == 0
    modes = [server.stations[n].vehicle.mode.number for n in (1, 2)]
    assert modes == [0, 17]
    assert main(["mission", "order", "pause", *common, "--only", "uav1"]) == 1
    assert "only a mission can be paused" in capsys.readouterr().err
    assert main(["mission", "order", "hold", *common, "--only", "uav9"]) == 2
