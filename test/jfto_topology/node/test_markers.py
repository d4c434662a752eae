"""Markers of a scene: what is drawn, and how a link's margin shows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from visualization_msgs.msg import Marker

from jfto_topology.core import Scene
from jfto_topology.node.markers import LINK_LOOKS, FleetMarkers

PATHS_M = {uav: np.zeros((4, 3)) for uav in ("uav1", "uav2", "uav3")}


def _scene(margin_db: float, linked: tuple[str, ...] = ("uav1", "uav2")) -> Scene:
    links = ~np.eye(len(linked), dtype=bool)
    return Scene(
        stamp_ns=10**18,
        paths_m=PATHS_M,
        positions_m=np.arange(9.0).reshape(3, 3),
        linked_ids=linked,
        links=links,
        margins_db=np.full(links.shape, margin_db),
    )


def _drawn(scene: Scene) -> list:
    return _fleet().draw(scene).markers


def _fleet() -> FleetMarkers:
    return FleetMarkers(PATHS_M)


def _of(markers, namespace: str) -> list:
    return [marker for marker in markers if marker.ns == namespace]


def test_everything_is_drawn_in_one_array() -> None:
    """All of the last is deleted first; paths, links, balls and names follow, in frame map."""
    markers = _drawn(_scene(10.0))
    assert markers[0].action == Marker.DELETEALL
    assert [len(_of(markers, name)) for name in ("paths", "links", "uavs", "names")] == [3, 1, 3, 3]
    assert {marker.header.frame_id for marker in markers[1:]} == {"map"}
    assert len({(marker.ns, marker.id) for marker in markers[1:]}) == len(markers) - 1
    assert len(_of(markers, "links")[0].points) == 2


def test_the_margin_shows_as_colour_and_as_width() -> None:
    """A weaker link has another colour and is drawn thicker."""
    looks = []
    for high, _, width_m in LINK_LOOKS:
        margin_db = 50.0 if np.isinf(high) else high - 0.5
        link = _of(_drawn(_scene(margin_db)), "links")[0]
        assert link.scale.x == width_m
        looks.append((link.color.r, link.color.g, link.color.b, link.scale.x))
    assert len(set(looks)) == len(LINK_LOOKS)
    widths = [look[3] for look in looks]
    assert widths == sorted(widths, reverse=True)


def test_a_negative_margin_is_the_weakest_look() -> None:
    """A link that a late pose makes too long is still drawn."""
    link = _of(_drawn(_scene(-5.0)), "links")[0]
    assert link.scale.x == LINK_LOOKS[0][2]


def test_a_uav_that_takes_no_part_looks_different() -> None:
    """Excluded UAVs are drawn where they are believed to be, in another colour."""
    balls = _of(_drawn(_scene(10.0)), "uavs")
    colours = [(ball.color.r, ball.color.g, ball.color.b) for ball in balls]
    assert colours[0] == colours[1] != colours[2]


def test_a_second_drawing_shows_what_is_new() -> None:
    """Nothing of the last slot stays: stamps, positions and colours are those of the new one."""
    fleet = _fleet()
    fleet.draw(_scene(10.0))
    later = replace(
        _scene(10.0, ("uav2", "uav3")), stamp_ns=2 * 10**18, positions_m=np.ones((3, 3))
    )
    markers = fleet.draw(later).markers
    assert markers == _drawn(later)
    assert {marker.header.stamp.sec for marker in markers[1:]} == {2 * 10**9}
