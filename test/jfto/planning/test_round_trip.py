"""Our own files come back as what was written."""

from __future__ import annotations

import numpy as np
import pytest

from jfto.analysis.export import write_waypoints
from jfto_mavlink.files import write_mission
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.settings import settings_for
from jfto_planner.coverage import read_waypoint_set, read_waypoints


def assert_same(found, expected):
    """Places to 5 cm (missions keep centimetres), angles to what a 32-bit float holds, in order."""
    assert len(found) == len(expected)
    places = np.array([w.position_m for w in found]) - [w.position_m for w in expected]
    assert np.abs(places).max() < 0.05
    turned = [
        (a.yaw_deg - b.yaw_deg + 180) % 360 - 180 for a, b in zip(found, expected, strict=True)
    ]
    assert np.abs(turned).max() < 1e-4
    tilted = [a.pitch_deg - b.pitch_deg for a, b in zip(found, expected, strict=True)]
    assert np.abs(tilted).max() < 1e-4


@pytest.mark.parametrize("mount", ["mount_control", "gimbal_manager"])
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
        assert_same(found.waypoints, [by_id[number] for number in route.waypoint_ids])
        assert any("passed over" in note for note in found.notes)


@pytest.mark.parametrize("suffix", [".csv", ".geojson"])
def test_written_waypoints_are_read_again(tiny_survey, tmp_path, suffix):
    """The table and the points of `jfto coverage -o`."""
    path = tmp_path / f"w{suffix}"
    write_waypoints(tiny_survey, path)
    assert_same(read_waypoints(path, tiny_survey.dem), tiny_survey.waypoints)
