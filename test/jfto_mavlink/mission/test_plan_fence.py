"""A plan's fence as vehicles carry it."""

from dataclasses import replace

import pytest

from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.fence import fence_from_items
from jfto_mavlink.mission.settings import MissionSettings
from jfto_msgs_py.records.site import Fence, Polygon, Zone
from jfto_msgs_py.scenario import make_scenario
from jfto_world.terrain.frame import LocalFrame
from support.plans import side_by_side

FIELD = ((-400.0, -400.0), (900.0, -400.0), (900.0, 900.0), (-400.0, 900.0))
HOLE = ((300.0, 300.0), (350.0, 300.0), (350.0, 350.0))


@pytest.fixture
def plan():
    """Three UAVs side by side."""
    return side_by_side(make_scenario([]))


def test_zones_without_heights_are_carried_and_the_fence_is_on(plan):
    """Polygons, holes and circles come as figures in degrees; zones with heights are named."""
    fence = Fence(
        (Polygon(FIELD, (HOLE,)),),
        (Zone("hut", HOLE), Zone("pond", (), (500.0, 500.0), 30.0), Zone("mast", HOLE, top_m=9.0)),
        5.0,
    )
    for built in build_missions(replace(plan, fence=fence), MissionSettings()):
        figures = fence_from_items(built.mission.fence)
        kinds = [(one.inclusion, len(one.vertices)) for one in figures.polygons]
        assert kinds == [(True, 4), (False, 3), (False, 3)]
        (circle,) = figures.circles
        assert (circle.radius_m, circle.inclusion) == (30.0, False)
        at = LocalFrame(plan.origin).to_enu(*circle.center, plan.origin.alt_m)
        assert at[:2] == pytest.approx([500.0, 500.0], abs=0.1)
        assert built.left_out == ("mast",)
        parameters = dict(built.mission.parameters)
        assert (parameters["FENCE_ENABLE"], parameters["FENCE_TYPE"]) == (1.0, 4.0)


def test_without_a_fence_what_is_on_board_stays(plan):
    """A plan without a fence, or with heights only, carries none and switches nothing."""
    for fence in (None, Fence((), (Zone("mast", HOLE, top_m=9.0),))):
        for built in build_missions(replace(plan, fence=fence), MissionSettings()):
            assert not built.mission.fence
            assert "FENCE_ENABLE" not in dict(built.mission.parameters)
