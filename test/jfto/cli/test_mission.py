"""jfto mission, on files and on simulated vehicles."""

from __future__ import annotations

import json
import socket
from pathlib import Path

import pytest

from jfto.cli import main
from jfto.simulation.fleet import UPTIME_S
from jfto_mavlink.files import read_mission
from jfto_sim import VehicleConfig
from jfto_sim.server import ServerSettings, SimServer


@pytest.fixture
def plan(tiny_run) -> Path:
    """The tiny scene's plan, its scenario beside it."""
    return tiny_run[0] / "plan.json"


@pytest.fixture
def vehicles(request):
    """Four simulated vehicles that speak to one port, and the roster of them; on for a while."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    configs = [VehicleConfig(sysid=n) for n in range(1, 5)]
    how = getattr(request, "param", {"uptime_s": UPTIME_S})
    settings = ServerSettings(((f"udpto:127.0.0.1:{port}",),) * 4, **how)
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
    assert verdict == "14 lines differ"
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


@pytest.mark.slow(6)
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


@pytest.mark.slow(6)
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


@pytest.mark.parametrize("vehicles", [{"uptime_s": 1.0}], indirect=True)
def test_what_is_not_ready_yet_is_amber_for_a_run_waits_for_it(plan, vehicles, capsys, monkeypatch):
    """Just switched on: no fix, no estimate; status 0, said in words and counted in JSON."""
    monkeypatch.setattr("jfto.cli.preflight._WAIT_S", 1.0)
    link = vehicles[1].rpartition("@")[2]
    assert main(["preflight", str(plan), "--vehicles", link, "--json"]) == 0
    page = json.loads(capsys.readouterr().out)
    waits = [f for one in page["vehicles"] for f in one["findings"] if f["waits"]]
    assert page["level"] == "amber"
    assert page["counts"]["waits"] == len(waits) >= 4
    assert page["counts"]["red"] == 0
    assert all(found["level"] == "amber" for found in waits)
    assert all("not ready yet, run waits for it" in found["text"] for found in waits)


def test_simulated_vehicles_have_the_faults_of_the_scenario(plan, capsys):
    """`simulated_fleet.faults` given to preflight counts: a vehicle whose compass fails is red."""
    fault = "simulated_fleet.faults=['param 2 SIM_MAG1_FAIL 1']"
    assert main(["preflight", str(plan), "--vehicles", "sim", "--json", "--set", fault]) == 1
    page = json.loads(capsys.readouterr().out)
    levels = {one["uav"]: {f["topic"]: f for f in one["findings"]} for one in page["vehicles"]}
    assert levels["uav2"]["autopilot"]["level"] == "red"
    assert "Compass not healthy" in levels["uav2"]["autopilot"]["text"]
    assert levels["uav1"]["autopilot"]["level"] == "green"


def test_who_is_waited_for_is_said(plan, capsys, monkeypatch):
    """A port where nobody listens: after 2 s each vehicle with its link, long before the end."""
    monkeypatch.setattr("jfto.cli.preflight._WAIT_S", 1.0)
    link = "tcp:127.0.0.1:9"
    assert main(["preflight", str(plan), "--vehicles", link, "--json"]) == 1
    told = capsys.readouterr()
    assert f"Waiting for uav1 on {link}, uav2 on {link}" in told.err
    page = json.loads(told.out)
    assert {f["topic"] for one in page["vehicles"] for f in one["findings"]} == {"identity"}


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


@pytest.mark.slow(6)
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


def edited(plan, folder, uav="uav2", **changes):
    """A mission as QGroundControl saves it after someone drew on it: fence, rally, a waypoint."""
    assert main(["mission", "export", str(plan), "-o", str(folder)]) == 0
    path = folder / f"{uav}.plan"
    document = json.loads(path.read_text())
    del document["jftoParameters"]
    lat, lon, _ = document["mission"]["plannedHomePosition"]
    for item in document["mission"]["items"]:
        if item["command"] == 16:
            item["params"][3] = None
    flown = [item for item in document["mission"]["items"] if item["command"] == 16]
    flown[1]["params"][4] += 2e-5
    flown[1]["params"][6] += changes.get("climb_m", 5.0)
    wide = changes.get("wide_deg", 0.02)
    corners = [[lat + a * wide, lon + b * wide] for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))]
    circle = {"center": [lat + 0.03, lon], "radius": 50.0}
    document["geoFence"] = {
        "version": 2,
        "polygons": [{"version": 1, "inclusion": True, "polygon": corners}],
        "circles": [{"version": 1, "inclusion": False, "circle": circle}],
    }
    document["rallyPoints"] = {"version": 2, "points": [[lat, lon, 40.0]]}
    path.write_text(json.dumps(document))
    return path


@pytest.mark.slow
def test_a_mission_edited_in_qgroundcontrol_is_uploaded(plan, vehicles, tmp_path, capsys):
    """With its fence and rally points, to the vehicle that it is for and no other, verified."""
    server, roster = vehicles
    path = edited(plan, tmp_path)
    link = roster.rpartition("@")[2]
    under = ["--scenario", str(plan.with_name("scenario.yaml"))]
    assert main(["mission", "upload", str(path), "--vehicles", link, *under]) == 0
    told = capsys.readouterr().out
    assert "uav2: " in told
    assert "5 fence, 1 rally points" in told
    assert "fleet released: 1 vehicles" in told
    stores = {n: station.vehicle.store for n, station in server.stations.items()}
    assert [stores[2].count(kind) for kind in (1, 2)] == [5, 1]
    assert stores[2].count(0) == len(read_mission(path).items)
    assert all(stores[n].count(0) == 0 for n in (1, 3, 4))
    assert main(["mission", "verify", str(path), "--vehicles", link, *under]) == 0
    other = tmp_path / "other.plan"
    other.write_bytes(path.read_bytes())
    common = ["--vehicles", link, *under]
    assert main(["mission", "verify", str(other), "--uav", "uav3", *common]) == 1
    assert "differences" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"climb_m": -500.0}, "above the ground, at least 5 m is wanted"),
        ({"climb_m": 3000.0}, "m above home is outside"),
        ({"wide_deg": 0.0002}, "the mission breaks its own fence: it gets"),
    ],
)
def test_an_edited_mission_is_held_to_what_ours_are(plan, tmp_path, capsys, changes, words):
    """Ground, heights and its own fence, before anything is sent."""
    path = edited(plan, tmp_path, **changes)
    scenario = str(plan.with_name("scenario.yaml"))
    arguments = ["--scenario", scenario, "--vehicles", "udpin:127.0.0.1:14999"]
    assert main(["mission", "upload", str(path), *arguments]) != 0
    told = capsys.readouterr().err
    assert words in told
    assert "uav2.plan" in told


def test_an_edited_mission_keeps_out_of_the_scenarios_zones(plan, tmp_path, capsys):
    """A leg into one is refused by the name of zone and item."""
    path = edited(plan, tmp_path)
    items = json.loads(path.read_text())["mission"]["items"]
    lat, lon = [item["params"][4:6] for item in items if item["command"] == 16][1]
    scenario = ["--scenario", str(plan.with_name("scenario.yaml"))]
    zone = f"fence.keep_out=[circle {lat} {lon} 15 name mast]"
    arguments = [*scenario, "--set", zone, "--vehicles", "udpin:127.0.0.1:14999"]
    assert main(["mission", "upload", str(path), *arguments]) != 0
    assert "leads into mast of the scenario's fence" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["m.plan", "--vehicles", "udpin:127.0.0.1:14999"], "--vehicles m=SYSID@udpin"),
        (["m.plan", "--vehicles", "udpin:127.0.0.1:14999"], "the name is that of the file m.plan"),
        (["m.plan", "--vehicles", "udpin:127.0.0.1:14999"], "as with --uav uav1"),
        (["m.plan", "--vehicles", "uav2=2@udpin:127.0.0.1:14999"], "as with --uav uav2"),
        (["m.plan", "--uav", "uav1", "--vehicles", "sim"], "Start them with jfto sim"),
        (["m.plan", "m.plan", "--vehicles", "x"], "give --uav once for each file"),
        (["m.plan", "plan.json", "--vehicles", "x"], "is no .plan or .waypoints file"),
        (["plan.json", "--uav", "uav1", "--vehicles", "x"], "says itself whose"),
        (["m.plan", "--set", "mavlink_bridge.height_max_m=9", "--vehicles", "x"], "--scenario"),
        (["none.plan", "--vehicles", "x"], "no such file"),
    ],
)
def test_whose_mission_a_file_is_has_to_be_clear(
    plan, tmp_path, monkeypatch, capsys, arguments, words
):
    """Status 2 and what to write instead; a link alone says who is meant only of uav1, uav2 …"""
    edited(plan, tmp_path).rename(tmp_path / "m.plan")
    (tmp_path / "plan.json").write_bytes(plan.read_bytes())
    monkeypatch.chdir(tmp_path)
    capsys.readouterr()
    assert main(["mission", "upload", *arguments]) == 2
    assert words in capsys.readouterr().err
