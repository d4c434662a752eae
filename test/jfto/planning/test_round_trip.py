"""Our own files come back as what was written."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from jfto.analysis.geo_plan import geo_plan_of, write_waypoints
from jfto.cli import main
from jfto.planning.routes import plan_routes
from jfto.planning.scenario_file import load_scenario
from jfto.planning.survey import survey
from jfto_mavlink.files import write_mission
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.settings import settings_for
from jfto_msgs_py.mission_file import FORMATS
from jfto_msgs_py.records.site import Fence, Polygon, Zone
from jfto_planner.coverage import Assumed, read_waypoint_set, read_waypoints
from jfto_world.mission.lines import LOOK_DEG as SAME_DEG
from jfto_world.mission.lines import PLACE_M

DATA = Path(__file__).parents[2] / "data"
TINY, CASES = DATA / "scenario/tiny.yaml", DATA / "cases"
SURVEY = """
/**:
  ros__parameters:
    terrain: {{source: {cases}/00-ground.tif, center_deg: [46.2, 7.6], size_m: [400.0, 400.0]}}
    waypoints: {{source: file, file: {cases}/02-survey-trigger.plan}}
    camera: {{sensor_mm: [17.3, 13.0], focal_length_mm: 15.0, image_px: [5280, 3956]}}
    coverage: {{trigger: {trigger}, distance_m: 80.0}}
    fleet: {{count: 2, speed_mps: [6.0], t_max_s: [2000.0], energy_j: [9000.0], p_max_dbm: [29.0]}}
    starts: {{count: 2}}
    network: {{k_min: 1}}
    mission: {{slot_count: 60}}
    search: {{moves: 100000, starts: 1}}
"""


def assert_same(found, expected, place_m=0.05, angle_deg=1e-4):
    """Places to 5 cm (missions keep centimetres), angles to what a 32-bit float holds, in order."""
    assert len(found) == len(expected)
    places = np.array([w.position_m for w in found]) - [w.position_m for w in expected]
    assert np.abs(places).max() < place_m
    turned = [
        (a.yaw_deg - b.yaw_deg + 180) % 360 - 180 for a, b in zip(found, expected, strict=True)
    ]
    assert np.abs(turned).max() < angle_deg
    tilted = [a.pitch_deg - b.pitch_deg for a, b in zip(found, expected, strict=True)]
    assert np.abs(tilted).max() < angle_deg


# A far place is told to 0.25 m of height, 1000 m away.
LOOK_DEG = 0.02


@pytest.mark.parametrize("mount", ["look_at", "mount_control", "gimbal_manager"])
@pytest.mark.parametrize("shutter", ["digicam", "image_capture"])
@pytest.mark.parametrize("suffix", [".plan", ".waypoints"])
def test_exported_missions_are_waypoints_again(
    tiny_run, tiny_survey, tmp_path, suffix, mount, shutter
):
    """Photos of each UAV with heading, pitch and height, in the order of its route.

    Waiting, the climb and the way home are no photos, and said to be passed over.
    """
    plan = tiny_run[1].plan
    by_id = {waypoint.id: waypoint for waypoint in plan.waypoints}
    settings = settings_for(plan, mount=mount, shutter=shutter)
    for built, route in zip(build_missions(plan, settings), plan.routes, strict=True):
        path = tmp_path / f"{built.uav}{suffix}"
        write_mission(path, built.mission)
        found = read_waypoint_set(path, tiny_survey.dem)
        expected = [by_id[number] for number in route.waypoint_ids]
        assert_same(found.waypoints, expected, angle_deg=LOOK_DEG if mount == "look_at" else 1e-4)
        assert any("passed over" in note for note in found.notes)


def read_again(plan, dem, folder) -> int:
    """Exports a plan's missions and holds what is read of them against it; the longest mission."""
    by_id = {waypoint.id: waypoint for waypoint in plan.waypoints}
    longest = 0
    for built, route in zip(build_missions(plan, settings_for(plan)), plan.routes, strict=True):
        path = folder / f"{built.uav}.plan"
        write_mission(path, built.mission)
        found = read_waypoint_set(path, dem)
        expected = [by_id[number] for number in route.waypoint_ids]
        assert_same(found.waypoints, expected, PLACE_M, SAME_DEG)
        assert not any("the last heading (115)" in note for note in found.notes)
        longest = max(longest, len(built.mission.items))
    return longest


@pytest.mark.slow
def test_380_waypoints_of_two_uavs_are_exported_and_read_back(tmp_path):
    """All look elsewhere, and both missions are within what an autopilot holds."""
    wanted = ["waypoints.count=380", "fleet.count=2", "fleet.p_max_dbm=29", "fleet.energy_j=9000"]
    wanted += ["network.k_min=1", "fleet.t_max_s=2500", "mission.length_max_m=100000"]
    loaded = load_scenario(TINY, [*wanted, "search.moves=20000"])
    found = survey(loaded)
    looks = np.random.default_rng(1).uniform((0.0, -80.0), (360.0, -40.0), (380, 2))
    waypoints = tuple(
        dataclasses.replace(waypoint, yaw_deg=float(yaw), pitch_deg=float(pitch))
        for waypoint, (yaw, pitch) in zip(found.waypoints, looks, strict=True)
    )
    found = dataclasses.replace(found, waypoints=waypoints)
    plan = plan_routes(loaded.scenario, found).plan
    assert plan.clean
    assert 550 < read_again(plan, found.dem, tmp_path) <= 650


@pytest.mark.parametrize("trigger", ["distance", "each"])
def test_a_survey_photographed_by_distance_comes_back(tmp_path, trigger):
    """QGroundControl's 176 photos on 8 lines: planned, exported, and read again as they were."""
    text = SURVEY.format(cases=CASES, trigger=trigger)
    (tmp_path / "survey.yaml").write_text(text)
    loaded = load_scenario(tmp_path / "survey.yaml")
    found = survey(loaded)
    plan = plan_routes(loaded.scenario, found).plan
    assert plan.clean
    on_lines = sum(line.last - line.first + 1 for route in plan.routes for line in route.lines)
    longest = read_again(plan, found.dem, tmp_path)
    if trigger == "distance":
        assert on_lines >= 160
        assert longest < 130
    else:
        assert on_lines == 0
        assert longest > 250


@pytest.mark.parametrize("suffix", [".csv", ".geojson", ".kml", ".kmz"])
def test_written_waypoints_are_read_again(tiny_survey, tmp_path, suffix):
    """The table and the points of `jfto coverage -o`."""
    path = tmp_path / f"w{suffix}"
    write_waypoints(tiny_survey, path)
    assert_same(read_waypoints(path, tiny_survey.dem), tiny_survey.waypoints)


@pytest.mark.parametrize("key", ["csv", "geojson", "kml", "kmz", "wpml", "litchi"])
def test_a_plan_written_for_other_programs_is_waypoints_again(
    tiny_run, tiny_survey, tmp_path, capsys, key
):
    """Of all UAVs in one file, or of each in its own, in the order of its route."""
    plan = tiny_run[1].plan
    by_id = {waypoint.id: waypoint for waypoint in plan.waypoints}
    given = str(tiny_run[0] / "plan.json")
    assert main(["mission", "export", given, "-o", str(tmp_path), "--format", key]) == 0
    told = capsys.readouterr()
    assert ("--drone" in told.err) == (key == "wpml")
    homes = told.out.count("--set waypoints.home_deg=")
    assert homes == (
        sum(map(bool, (r.waypoint_ids for r in plan.routes))) if key == "litchi" else 0
    )
    routes = {uav.id: r.waypoint_ids for uav, r in zip(plan.uavs, plan.routes, strict=True)}
    if not next(form for form in FORMATS if form.key == key).per_uav:
        routes = {"plan": [number for ids in routes.values() for number in ids]}
    assert len(list(tmp_path.iterdir())) == len(routes)
    for path in tmp_path.iterdir():
        frame = tiny_survey.dem.frame
        pad = next((u.start_m for u in plan.uavs if u.id == path.stem), plan.uavs[0].start_m)
        lat, lon, _ = (float(value) for value in frame.to_geodetic(pad))
        found = read_waypoints(path, tiny_survey.dem, Assumed((lat, lon)))
        assert_same(found, [by_id[number] for number in routes[path.stem]])


def test_area_zones_and_places_only_passed_are_written(tiny_run, tiny_survey, tmp_path):
    """Circles as polygons around them, heights above sea level; what is passed gets no photo."""
    plan = tiny_run[1].plan
    ring = ((0.0, 0.0), (100.0, 0.0), (100.0, 50.0))
    zones = (Zone("mast", centre_m=(50.0, 20.0), radius_m=30.0, top_m=90.0), Zone("wood", ring))
    first = plan.routes[0].waypoint_ids[0]
    passed = dataclasses.replace(
        plan,
        area=(Polygon(ring, (ring[:3],)),),
        fence=Fence((Polygon(ring),), zones, 5.0),
        waypoints=tuple(
            dataclasses.replace(w, photo=w.id != first) if w.id == first else w
            for w in plan.waypoints
        ),
    )
    site = geo_plan_of(passed, tiny_survey.dem, "site")
    mast, wood = site.keep_out
    assert mast.top_m == pytest.approx(plan.origin.alt_m + 90.0, abs=0.01)
    assert (wood.bottom_m, wood.top_m) == (None, None)
    corners = np.array([tiny_survey.dem.to_enu(*one, plan.origin.alt_m) for one in mast.outer])
    middles = (corners + np.roll(corners, 1, axis=0))[:, :2] / 2 - (50.0, 20.0)
    assert np.hypot(*middles.T).min() == pytest.approx(30.0, abs=1e-3)
    assert len(site.area[0].holes) == len(site.keep_in) == 1
    for key in ("csv", "geojson", "kml"):
        form = next(each for each in FORMATS if each.key == key)
        path = tmp_path / f"w{form.suffixes[0]}"
        path.write_bytes(form.write(site))
        found = read_waypoint_set(path, tiny_survey.dem)
        assert len(found.waypoints) == sum(len(r.waypoint_ids) for r in plan.routes) - 1
        assert any("left out" in note for note in found.notes)
