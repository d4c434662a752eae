"""Bad scenarios, elevation models, waypoint files and plans: status 2, and words that help."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from jfto.cli import main
from jfto.pipeline.run import Run

_HEAD = "/**:\n  ros__parameters:\n"

# Scenario text below `ros__parameters:`, then the key and the cure that the message must name.
SCENARIOS = {
    "out of range": (
        "fleet: {p_max_dbm: [300.0]}",
        "fleet.p_max_dbm[0] is 300",
        "Did you mean 30?",
    ),
    "wrong sign": ("radio: {sensitivity_dbm: 70.0}", "radio.sensitivity_dbm", "Did you mean -70?"),
    "percent": ("coverage: {overlap_h: 30.0}", "coverage.overlap_h", "Did you mean 0.3?"),
    "no overlap": ("coverage: {overlap_v: 0.0}", "coverage.overlap_v", "inside the range"),
    "kilometres": ("terrain: {size_m: [2.0, 2.0]}", "terrain.size_m[0]", "Did you mean 20?"),
    "unknown key": ("radio: {bandwith_hz: 1.0}", "radio.bandwith_hz", "radio.bandwidth_hz?"),
    "wrong part": ("fleet: {k_min: 2}", "fleet.k_min", "Did you mean network.k_min?"),
    "unknown part": ("battery: {cells: 4}", "battery.cells", "docs/reference/scenario.md"),
    "unit in value": ("radio: {noise_dbm: -110 dBm}", "radio.noise_dbm", "Did you mean -110?"),
    "word for number": ("fleet: {speed_mps: [fast]}", "fleet.speed_mps[0]", "0.1…60 m/s"),
    "fraction of a UAV": ("fleet: {count: 3.5}", "fleet.count is 3.5", "Did you mean 4?"),
    "flag for number": ("fleet: {count: true}", "fleet.count", "whole number"),
    "number for flag": ("terrain: {zero_is_void: 1}", "terrain.zero_is_void", "true or false"),
    "number for text": ("terrain: {source: 5}", "terrain.source is 5", 'Write "5" in quotes'),
    "not a number": ("radio: {gain_tx_dbi: .nan}", "radio.gain_tx_dbi is nan", "finite"),
    "infinite": ("mission: {length_max_m: .inf}", "mission.length_max_m", "finite"),
    "list for scalar": ("network: {k_min: [2]}", "network.k_min", "no list"),
    "map for scalar": (
        "network: {k_min: {a: 2}}",
        "network.k_min.a",
        "Did you mean network.k_min?",
    ),
    "wrong choice": ("waypoints: {source: gausian}", "waypoints.source", "Did you mean gaussian?"),
    "wrong count": ("fleet: {count: 4, energy_j: [1.0, 2.0]}", "fleet.energy_j", "one per UAV"),
    "too few names": ("fleet: {count: 3, ids: [a, b]}", "fleet.ids", "set fleet.count to 2"),
    "same name": ("fleet: {count: 3, ids: [a, b, a]}", "fleet.ids[2]", "a name of its own"),
    "no ROS name": ("fleet: {count: 3, ids: [1a, b, c]}", "fleet.ids[0]", "must be a ROS name"),
    "too many neighbours": ("fleet: {count: 2}", "network.k_min is 2", "Set it to 1 or less"),
    "late n_DC": (
        "mission: {slot_count: 9}\n    evaluation: {n_dc: 10}",
        "evaluation.n_dc",
        "Lower",
    ),
    "no waypoint file": ("waypoints: {source: file}", "waypoints.file", "Name the file"),
    "waypoint file not asked for": (
        "waypoints: {file: mission.kml}",
        "waypoints.file is given, but waypoints.source is coverage",
        "Set it to file, or remove the file",
    ),
    "home of waypoints that are drawn": (
        "waypoints: {source: uniform, home_deg: [36.6, -84.2]}",
        "waypoints.home_deg is given, but waypoints.source is uniform",
        "Set it to file, or remove the home",
    ),
    "odd coordinates": ("starts: {positions_m: [1.0, 2.0, 3.0]}", "starts.positions_m", "pairs"),
    "more starts than UAVs": ("starts: {count: 9}", "starts.count is 9", "Set it to 8 or less"),
    "half a centre": ("terrain: {center_deg: [36.6]}", "terrain.center_deg", "needs 2"),
    "longitude first": ("terrain: {center_deg: [120.0, 30.0]}", "terrain.center_deg", "latitude"),
    "footprint alone": ("camera: {footprint_m: [9.0, 6.0]}", "camera.footprint_m", "distance_m"),
    "crossed pitch": (
        "coverage: {pitch_min_deg: 0.0, pitch_max_deg: -9.0}",
        "coverage.pitch_min_deg",
        "Exchange them",
    ),
    "both gains": (
        "radio: {antenna_gain_dbi: 3.0, gain_tx_dbi: 2.0}",
        "radio.antenna_gain_dbi",
        "Give one of them",
    ),
    "given twice": ("network: {k_min: 1, k_min: 2}", "network.k_min", "Remove one"),
    "alias": ("network: &a {k_min: 2}\n    mission: *a", "*a", "Write the value out"),
    "no such model": ("terrain: {source: none.tif}", "none.tif", "Name a DEM file"),
    "outside the model": ("terrain: {center_deg: [46.0, 8.0]}", "jacksboro", "Move the centre"),
    "no such area": ("area: {file: none.kml}", "area.file", "Check the path"),
    "two areas": (
        "area: {file: a.kml, polygon_deg: [36.62, -84.27, 36.62, -84.26, 36.63, -84.26]}",
        "area.polygon_deg",
        "Remove one of them",
    ),
    "half a corner": ("area: {polygon_deg: [36.6, -84.2, 36.7]}", "area.polygon_deg", "3 corners"),
    "area of longitudes first": (
        "area: {polygon_deg: [-94.27, 36.62, -94.26, 36.62, -94.26, 36.63]}",
        "area.polygon_deg",
        "latitude before longitude",
    ),
    "exchanged area": (
        "area: {polygon_deg: [-84.27, 36.62, -84.26, 36.62, -84.26, 36.63]}",
        "area.polygon_deg",
        "Exchange them",
    ),
    "crossed area": (
        "area: {polygon_deg: [36.62, -84.27, 36.63, -84.26, 36.62, -84.26, 36.63, -84.27]}",
        "area.polygon_deg",
        "crosses itself near 36.62",
    ),
    "buffer of nothing": ("area: {buffer_m: 20.0}", "area.buffer_m", "area.file or area.polygon"),
    "layer of nothing": ("area: {layer: fields}", "area.layer", "area.file"),
    "area beyond its rectangle": (
        (
            "area: {polygon_deg: [36.62, -84.27, 36.62, -84.26, 36.63, -84.26]}\n"
            "    terrain: {size_m: [300.0, 300.0]}"
        ),
        "terrain.size_m is 300 m",
        "Leave out terrain.size_m",
    ),
    "heading of a circle and more": (
        "coverage: {heading_deg: 900.0}",
        "coverage.heading_deg",
        "Did you mean 90?",
    ),
    "too large for the model": ("terrain: {size_m: [49000.0, 49000.0]}", "jacksboro", "size"),
}


@pytest.mark.parametrize("case", SCENARIOS)
def test_bad_scenario(case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A wrong value stops everything, with file, key and cure named."""
    text, key, cure = SCENARIOS[case]
    path = tmp_path / "mine.yaml"
    path.write_text(f"{_HEAD}    {text}\n")
    assert main(["plan", str(path), "-o", str(tmp_path / "plan.json")]) == 2
    said = capsys.readouterr().err
    assert "mine.yaml" in said, said
    assert key in said, said
    assert cure in said, said
    assert "Traceback" not in said
    assert not (tmp_path / "plan.json").exists()


# Whole scenario files, and what the message must name.
FILES: dict[str, tuple[bytes, str, str]] = {
    "empty": (b"", "mine.yaml", "ros__parameters"),
    "a list": (b"- 1\n- 2\n", "mine.yaml", "ros__parameters"),
    "binary": (bytes(range(128, 256)), "mine.yaml", "UTF-8"),
    "broken YAML": (b"/**:\n  ros__parameters: [1,\n", "mine.yaml:", "brackets"),
    "tabs": (b"/**:\n\tros__parameters:\n", "mine.yaml:2", "indentation"),
    "no parameters": (b"/**:\n  radio: {noise_dbm: -110.0}\n", "mine.yaml:1", "ros__parameters"),
    "bare keys": (b"radio:\n  noise_dbm: -110.0\n", "unknown section radio", "Put it below"),
    "unknown node": (b"planer_node:\n  ros__parameters: {}\n", "planer_node", "planner_node?"),
    "nodes disagree": (
        (
            b"planner_node:\n  ros__parameters: {network: {k_min: 1}}\n"
            b"topology_node:\n  ros__parameters: {network: {k_min: 2}}\n"
        ),
        "network.k_min",
        "Nodes must agree",
    ),
}


@pytest.mark.parametrize("case", FILES)
def test_bad_scenario_file(case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A file that is no scenario is said to be none, with the line where there is one."""
    content, key, cure = FILES[case]
    path = tmp_path / "mine.yaml"
    path.write_bytes(content)
    assert main(["run", str(path), "--out", str(tmp_path / "run")]) == 2
    said = capsys.readouterr().err
    assert "mine.yaml" in said
    assert key in said, said
    assert cure in said, said
    assert not (tmp_path / "run").exists()


def _drop(key: str) -> Callable[[dict[str, Any]], None]:
    return lambda plan: plan.pop(key)


def _put(*path: Any) -> Callable[[dict[str, Any]], None]:
    """Put the last of `path` where the others lead."""

    def change(plan: Any) -> None:
        *way, last, value = path
        for step in way:
            plan = plan[step]
        plan[last] = value

    return change


PLANS: dict[str, tuple[Callable[[dict[str, Any]], None], str, str]] = {
    "another format": (_put("format", "plan"), "format", "jfto plan"),
    "later version": (_put("version", 99), "version is 99", "anew"),
    "missing key": (_drop("slots"), "slots", "anew"),
    "missing positions": (_drop("positions_m"), "positions_m", "anew"),
    "unknown key": (_put("positons_m", []), "positons_m", "Did you mean positions_m?"),
    "not a number": (_put("d_min_m", "10 m"), "d_min_m", "must be a number"),
    "negative": (_put("d_min_m", -1), "d_min_m is -1", "at least 0"),
    "no slots": (_put("slots", "count", 0), "slots.count is 0", "at least 1"),
    "no duration": (_put("slots", "duration_s", 0), "slots.duration_s", "positive"),
    "latitude": (_put("origin", "lat", 91), "origin.lat is 91", "-90…90"),
    "no UAV": (_put("uavs", []), "uavs", "at least one"),
    "k_min": (_put("k_min", 4), "k_min is 4", "at most 3 neighbours"),
    "radio": (_put("radio", "bandwidth_hz", -1), "radio.bandwidth_hz", "positive"),
    "noise reading": (_put("radio", "noise_reading", "loud"), "noise_reading", "per_hertz"),
    "speed": (_put("uavs", 0, "speed_mps", 0), "uavs[0].speed_mps", "positive"),
    "unknown waypoint": (_put("uavs", 1, "route", 0, 999), "uavs[1].route[0] is 999", "Correct"),
    "times": (_put("uavs", 0, "arrival_s", []), "uavs[0].arrival_s", "one per waypoint"),
    "backwards": (_put("uavs", 0, "arrival_s", 0, 1e9), "uavs[0].arrival_s", "not decrease"),
    "same waypoint": (_put("waypoints", 1, "id", 0), "waypoints[1].id", "must differ"),
    "flat position": (_put("waypoints", 0, "position_m", [1, 2]), "waypoints[0]", "needs 3"),
    "one UAV less": (lambda plan: plan["uavs"].pop(), "positions_m", "needs 3"),
    "one instant less": (lambda plan: plan["positions_m"][0].pop(), "positions_m[0]", "needs 11"),
    "null position": (_put("positions_m", 0, 0, 0, None), "positions_m[0][0][0]", "a number"),
    "time model": (_put("time_model", "warp"), "time_model", "constant_speed"),
}


@pytest.mark.parametrize("case", PLANS)
def test_bad_plan(
    case: str, tiny_run: tuple[Path, Run], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A plan that contradicts itself or the format is refused, place and cure named."""
    change, key, cure = PLANS[case]
    plan = json.loads((tiny_run[0] / "plan.json").read_text())
    change(plan)
    path = tmp_path / "broken.json"
    path.write_text(json.dumps(plan))
    assert main(["check", str(path)]) == 2
    said = capsys.readouterr().err
    assert "broken.json" in said, said
    assert key in said, said
    assert cure in said, said
    assert "Traceback" not in said


TEXTS = {
    "empty": ("", "not valid JSON", "jfto plan"),
    "cut off": ('{"format": "jfto-plan", "ver', "not valid JSON", "complete"),
    "not a number": ('{"format": NaN}', "NaN", "anew"),
    "given twice": ('{"seed": 1, "seed": 2}', "seed is given twice", "Remove one"),
    "a list": ("[]", "is not a plan", "jfto plan"),
    "too deep": ("[" * 100_000, "too deep", "plan file"),
}


@pytest.mark.parametrize("case", TEXTS)
@pytest.mark.parametrize("command", ["check", "evaluate"])
def test_bad_plan_text(
    case: str, command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Text that is no plan is said to be none, by every command that reads plans."""
    text, reason, cure = TEXTS[case]
    path = tmp_path / "broken.json"
    path.write_text(text)
    assert main([command, str(path)]) == 2
    said = capsys.readouterr().err
    assert "broken.json" in said
    assert reason in said, said
    assert cure in said, said


def test_files_that_are_none(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A missing file, a directory and an unwritable place are named, with what to do."""
    (tmp_path / "there.yaml").write_text(_HEAD + "    network: {k_min: 2}\n")
    (tmp_path / "file").write_text("")
    for arguments, reason in (
        (["plan", str(tmp_path / "mine.yaml")], "there.yaml"),
        (["plan", str(tmp_path / "no" / "mine.yaml")], "no directory"),
        (["plan", str(tmp_path)], "is a directory"),
        (["check", str(tmp_path)], "is a directory"),
        (["report", str(tmp_path)], "jfto run SCENARIO"),
        (["report", str(tmp_path / "none")], "no directory"),
        (["run", str(tmp_path / "there.yaml"), "-o", str(tmp_path / "file")], "--out"),
    ):
        assert main(arguments) == 2, arguments
        said = capsys.readouterr().err
        assert str(tmp_path) in said
        assert reason in said, said


def test_bad_elevation_models(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Unreadable, empty and void elevation models are refused by name."""
    for name, content in (
        ("noise.tif", b"not a picture"),
        ("short.hgt", b"\0" * 10),
        ("empty.asc", b""),
        (
            "void.asc",
            b"ncols 3\nnrows 3\nxllcorner 8\nyllcorner 46\ncellsize 0.01\nNODATA_value -1\n"
            + b"-1 -1 -1\n" * 3,
        ),
    ):
        (tmp_path / name).write_bytes(content)
        path = tmp_path / "mine.yaml"
        path.write_text(f"{_HEAD}    terrain: {{source: {name}, size_m: [100.0, 100.0]}}\n")
        assert main(["coverage", str(path)]) == 2, name
        said = capsys.readouterr().err
        assert name in said, said
        assert "Traceback" not in said


@pytest.mark.parametrize(
    "override",
    ["radio.noise_dbm", "=3", "radio.noise_dbm=loud", "radio.nose_dbm=-100", "fleet.count=[3"],
)
def test_bad_override(tiny: Path, override: str, capsys: pytest.CaptureFixture[str]) -> None:
    """A wrong --set is refused as such."""
    assert main(["plan", str(tiny), "--set", override]) == 2
    said = capsys.readouterr().err
    assert "--set" in said
    assert "1 problem. Nothing was done." in said


def test_all_problems_are_listed_at_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """One look at the message is enough to mend the whole file, line by line."""
    path = tmp_path / "mine.yaml"
    radio = "    radio:\n      bandwith_hz: 1.0\n      noise_dbm: 110.0\n"
    path.write_text(f"{_HEAD}{radio}    mission: {{d: 1}}\n")
    assert main(["plan", str(path), "--set", "network.k_min=-1"]) == 2
    said = capsys.readouterr().err
    assert "mine.yaml:4: unknown key radio.bandwith_hz" in said
    assert "mine.yaml:5: radio.noise_dbm is 110" in said
    assert "mine.yaml:6: unknown key mission.d" in said
    assert "--set: network.k_min is -1" in said
    assert "4 problems. Nothing was done." in said
