"""Who flies, as `jfto up --vehicles` names them."""

from __future__ import annotations

import pytest

from jfto.supervision.graph import graph_commands
from jfto.supervision.graph_table import GraphOptions, graph_table
from jfto.supervision.vehicles import choose_vehicles
from jfto_msgs_py.errors import JftoError

UAVS = ("uav1", "uav2")


def test_simulated_vehicles_and_their_bridge_share_link_speed_and_time(tmp_path) -> None:
    """The whole graph keeps the vehicles' time; the scenario's roster is for others."""
    chosen = choose_vehicles(["sim:2"], UAVS, {}, speedup=8.0)
    fleet, bridge = chosen.given["simulated_fleet"], chosen.given["mavlink_bridge"]
    assert bridge["endpoints"] == (str(fleet["endpoint"]).replace("udpto", "udpin"),)
    assert (fleet["speedup"], bridge["speedup"], bridge["vehicle_stamps"]) == (8.0, 8.0, True)
    scenario = {"mavlink_bridge": {"roster": ("uav1=7@tcp:a:1",), "telemetry_rate_hz": 2.0}}
    options = GraphOptions(
        tmp_path / "s.yaml", tmp_path, tmp_path / "plan.json", chosen, record=True,
        sections=scenario,
    )  # fmt: skip
    table = {row.name: row.parameters for row in graph_table(options)}
    assert "roster" not in table["mavlink_bridge"]
    assert table["mavlink_bridge"]["telemetry_rate_hz"] == 2.0
    assert table["topology_node"]["pose_wait_s"] == 1.0
    assert table["planner_node"]["await_lift_off"] is True
    commands = {node.name: list(node.command) for node in graph_commands(options)}
    assert list(commands) == [
        "recorder", "simulated_fleet", "planner_node", "topology_node", "power_node",
        "radio_node", "mavlink_bridge",
    ]  # fmt: skip
    assert "driver:=sim" in commands["radio_node"]
    control = f"control:=127.0.0.1:{fleet['control_port']}"
    assert control in commands["radio_node"]
    assert "--use-sim-time" in commands["recorder"]
    assert all("use_sim_time:=true" in c for n, c in commands.items() if n != "recorder")
    link = f'endpoints:=["udpin:{str(fleet["endpoint"]).partition(":")[2]}"]'
    assert link in commands["mavlink_bridge"]


@pytest.mark.parametrize(
    ("texts", "bridge"),
    [
        (["udpin:0.0.0.0:14550"], {"endpoints": ("udpin:0.0.0.0:14550",)}),
        (["tcp:a:1", "serial:/dev/ttyUSB0"],
         {"endpoints": ("tcp:a:1", "serial:/dev/ttyUSB0:57600")}),
        (["uav1=3@udpin:0.0.0.0:1", "uav2=4@udpin:0.0.0.0:1"],
         {"roster": ("uav1=3@udpin:0.0.0.0:1", "uav2=4@udpin:0.0.0.0:1")}),
        (["roster"], {"endpoints": ("tcp:b:2",), "key_file": "k"}),
    ],
)  # fmt: skip
def test_real_vehicles_keep_time_and_are_not_armed(texts, bridge) -> None:
    """Links, entries or the scenario's own section; nothing is simulated."""
    section = {"endpoints": ("tcp:b:2",), "key_file": "k", "style": "hold"}
    chosen = choose_vehicles(texts, UAVS, section)
    assert not chosen.simulated
    assert chosen.given == {"mavlink_bridge": bridge}
    armed = choose_vehicles(texts, UAVS, section, arm=True)
    assert armed.given["mavlink_bridge"]["allow_arming"] is True


@pytest.mark.parametrize(
    ("texts", "options", "words"),
    [
        (["sim:3"], {}, "sim:3: the fleet has 2 UAVs"),
        (["sim", "tcp:a:1"], {}, "must be sim or sim:2"),
        (["tcp:a:1"], {"speedup": 2.0}, "--speedup is for simulated"),
        (["roster"], {}, "names no roster"),
        (["tcp:a:1", "tcp:b:1", "tcp:c:1"], {}, "endpoints has 3"),
        (["udp:a:1"], {}, "must begin with one of udpin:"),
        (["uav1=1@tcp:a:1"], {}, "uav2: in the fleet or in the roster"),
    ],
)
def test_others_are_refused_in_words(texts, options, words) -> None:
    """Before anything is started."""
    with pytest.raises(JftoError, match=words):
        choose_vehicles(texts, UAVS, {}, **options)


def test_every_flight_begins_when_the_fleet_does() -> None:
    """Missions and streamed trajectories alike: the planner awaits the lift-off that is told."""
    for texts in (["sim"], ["udpin:0.0.0.0:1"]):
        suited = choose_vehicles(texts, UAVS, {}).suited
        assert suited["planner_node"] == {"await_lift_off": True}
