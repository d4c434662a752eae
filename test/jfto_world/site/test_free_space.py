"""Ways round no-fly zones, against shapely's own geometry."""

import itertools

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.records.site import Fence, Polygon, Zone
from jfto_planner.routing.detours import detours_of
from jfto_world.site.free_space import SPARE_M, FreeSpace

WALL = Zone("wall", ((-50.0, -200.0), (50.0, -200.0), (50.0, 300.0), (-50.0, 300.0)))
SQUARE = ((-400.0, -400.0), (400.0, -400.0), (400.0, 400.0), (-400.0, 400.0))


def shortest_m(zones, begin, end):
    """Length of the shortest path by brute force over all orders of corners of grown zones."""
    core = shapely.union_all([zone.buffer(-1e-6, join_style="mitre") for zone in zones])
    corners = [tuple(c) for zone in zones for c in shapely.get_coordinates(zone)[:-1]]
    best = np.inf
    for count in range(5):
        for between in itertools.permutations(corners, count):
            line = shapely.LineString([begin, *between, end])
            if line.length < best and not shapely.intersects(core, line):
                best = line.length
    return best


def way(fence, begin, end):
    """The way between two places (3,) as a line (K, 2)."""
    nodes = np.array([begin, end], dtype=float)
    found = FreeSpace(fence).ways(nodes, np.array([[0, 1]]))
    assert not found.closed[0]
    return np.concatenate([nodes[:1, :2], found.vias, nodes[1:, :2]])


def length_m(line):
    return float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())


def test_a_wall_is_passed_at_its_nearer_end():
    """Round a wall the way turns at the margin from its two lower corners."""
    line = way(Fence((), (WALL,), 10.0), (-100, 0, 50), (100, 0, 50))
    by = 10.0 + SPARE_M
    assert line[1:-1] == pytest.approx(np.array([[-50 - by, -200 - by], [50 + by, -200 - by]]))


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000))
def test_lengths_are_those_of_brute_force(seed):
    """Round two random quadrangles the way is as short as the best of all orders of corners."""
    rng = np.random.default_rng(seed)
    zones, shapes = [], []
    for k, middle in enumerate(((-70.0, 0.0), (70.0, 0.0))):
        turns = np.sort(rng.uniform(0, 2 * np.pi, 4))
        turns = np.arange(4) * np.pi / 2 + 0.3 * (turns - turns.mean()) / np.pi
        size = rng.uniform(30, 60)
        ring = np.array(middle) + size * np.column_stack([np.cos(turns), np.sin(turns)])
        zones.append(Zone(f"z{k}", tuple(map(tuple, ring.tolist()))))
        shapes.append(
            shapely.Polygon(ring).buffer(5 + SPARE_M, join_style="mitre", mitre_limit=1.5)
        )
    begin, end = (-200.0, float(rng.uniform(-60, 60))), (200.0, float(rng.uniform(-60, 60)))
    if (
        shapely.intersects(shapes[0], shapes[1])
        or max(len(shapely.get_coordinates(s)) for s in shapes) > 6
    ):
        return
    line = way(Fence((), tuple(zones), 5.0), (*begin, 0.0), (*end, 0.0))
    assert length_m(line) == pytest.approx(shortest_m(shapes, begin, end), abs=1e-3)


def test_nothing_leads_out_of_a_ring_of_zones():
    """A place that is walled off has no way, and the pair is closed."""
    ring = tuple(
        Zone(f"z{k}", (), (100 * np.cos(k * np.pi / 8), 100 * np.sin(k * np.pi / 8)), 30.0)
        for k in range(16)
    )
    nodes = np.array([[0.0, 0, 10], [300.0, 0, 10], [320.0, 0, 10]])
    detours, closed = detours_of(FreeSpace(Fence((), ring, 5.0)), nodes, nodes[2:])
    assert closed[0, 1]
    assert closed[1, 0]
    assert not closed[1, 2]
    assert (detours.index == -1).all()


def test_a_leg_high_over_a_zone_is_straight():
    """Over a zone with a top a leg is free by the margin, and not a decimetre lower."""
    mast = Fence((), (Zone("mast", (), (0.0, 0.0), 50.0, None, 100.0),), 10.0)
    free = FreeSpace(mast)
    begin, end = np.array([[-200.0, 0, 0]]), np.array([[200.0, 0, 0]])
    for height_m, crossed in ((110.0 + 2 * SPARE_M, False), (109.9, True)):
        up = np.array([[0, 0, height_m]])
        assert free.crossed(begin + up, end + up)[0] == crossed
    # It may be lower where it is beside the zone.
    assert not free.crossed(begin, np.array([[200.0, 0, 600.0]]))[0]


def test_what_is_to_be_kept_in_is_not_left():
    """A way round a bay of the outline stays inside of it by the margin."""
    bay = Polygon(
        ((-300.0, -300.0), (300.0, -300.0), (300.0, 300.0), (20.0, 300.0), (20.0, -100.0),
         (-20.0, -100.0), (-20.0, 300.0), (-300.0, 300.0))
    )  # fmt: skip
    line = way(Fence((bay,), (), 10.0), (-100, 200, 0), (100, 200, 0))
    shape = shapely.Polygon(bay.outer)
    assert shapely.contains(shape, shapely.LineString(line))
    assert shapely.distance(shape.exterior, shapely.LineString(line)) >= 10.0


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10_000))
def test_every_way_keeps_its_distance(seed):
    """Between random places round random zones, ways keep the margin; what is inside is named."""
    rng = np.random.default_rng(seed)
    zones = tuple(
        Zone(
            f"z{k}",
            (),
            tuple(rng.uniform(-300, 300, 2).tolist()),
            float(rng.uniform(10, 90)),
            None,
            float(rng.uniform(20, 120)) if rng.random() < 0.5 else None,
        )
        for k in range(6)
    )
    fence = Fence((Polygon(SQUARE),), zones, float(rng.uniform(0, 15)))
    free = FreeSpace(fence)
    nodes = np.column_stack([rng.uniform(-380, 380, (12, 2)), rng.uniform(10, 150, 12)])
    nodes = nodes[[not name for name in free.inside(nodes)]]
    if len(nodes) < 3:
        return
    detours, closed = detours_of(free, nodes, nodes[-1:])
    edge = shapely.Polygon(SQUARE).exterior
    for i, j in itertools.combinations(range(len(nodes)), 2):
        if closed[i, j]:
            continue
        line = np.concatenate([nodes[[i]], detours.between(i, j), nodes[[j]]])
        share = np.linspace(0, 1, 200)[:, None]
        places = np.concatenate([a + share * (b - a) for a, b in itertools.pairwise(line)])
        points = shapely.points(places[:, :2])
        assert shapely.distance(edge, points).min() >= fence.margin_m
        for zone in zones:
            top = np.inf if zone.top_m is None else zone.top_m + fence.margin_m
            low = places[:, 2] < top
            apart = np.linalg.norm(places[low, :2] - zone.centre_m, axis=1) - zone.radius_m
            assert apart.min(initial=np.inf) >= fence.margin_m
        assert length_m(line[:, :2]) >= np.linalg.norm(line[-1, :2] - line[0, :2]) - 1e-9
