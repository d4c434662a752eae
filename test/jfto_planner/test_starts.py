import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import InfeasibleError, InputError
from jfto_planner.starts import check_starts, choose_starts, place_pads, share_out


def hill(x, y):
    """Made-up ground."""
    return 80 * np.sin(x / 300) * np.cos(y / 200)


def scene(seed, count=60, side=2000.0):
    rng = np.random.default_rng(seed)
    return np.column_stack([rng.uniform(-side / 2, side / 2, (count, 2)), np.full(count, 200.0)])


@pytest.mark.slow
@settings(deadline=None, derandomize=True, max_examples=60)
@given(
    st.integers(0, 2**32 - 1),
    st.integers(3, 14),
    st.integers(1, 6),
    st.floats(120, 2500),
    st.integers(1, 2),
)
def test_chosen_pads_keep_every_rule(seed, fleet, starts, reach, k_min):
    """Whatever the scene, chosen pads lie on the ground and pass check_starts."""
    rng = np.random.default_rng(seed)
    reaches = reach * rng.uniform(0.6, 1.0, fleet)
    starts = min(starts, fleet)
    pads = choose_starts(scene(seed), starts, reaches, k_min, 10.0, hill, rng)
    assert pads.shape == (fleet, 3)
    assert pads[:, 2] == pytest.approx(hill(pads[:, 0], pads[:, 1]))
    check_starts(pads, reaches, k_min, 10.0)


def test_with_ample_reach_starts_stay_in_the_middle_of_their_waypoints():
    """Four separate clusters, reach beyond all: one start in each, UAVs by cluster size."""
    rng = np.random.default_rng(0)
    centres = np.array([[-800, -800], [800, -800], [-800, 800], [800, 800]])
    sizes = [10, 20, 30, 60]
    waypoints = np.concatenate(
        [c + rng.normal(size=(n, 2)) * 50 for c, n in zip(centres, sizes, strict=True)]
    )
    waypoints = np.column_stack([waypoints, np.zeros(len(waypoints))])
    pads = choose_starts(waypoints, 4, np.full(12, 5000.0), 2, 10.0, hill, np.random.default_rng(1))
    distance = np.linalg.norm(pads[:, None, :2] - centres[None], axis=-1)
    assert distance.min(axis=1).max() < 60
    assert np.bincount(distance.argmin(axis=1)).tolist() == [1, 2, 3, 6]


def test_short_reach_draws_the_starts_together_no_more_than_needed():
    """Starts spread more with more reach, and the farthest needed link is nearly used up."""
    spans = []
    for reach in (300.0, 600.0, 900.0):
        pads = choose_starts(
            scene(5), 4, np.full(4, reach), 2, 10.0, hill, np.random.default_rng(2)
        )
        distance = np.linalg.norm(pads[:, None] - pads[None], axis=-1)
        second = np.sort(distance, axis=1)[:, 2].max()
        assert 0.95 * reach <= second <= reach
        spans.append(np.ptp(pads[:, 0]))
    assert spans == sorted(spans)


def test_the_longest_reach_goes_to_the_outermost_start():
    """In a fleet of unequal radios the strong ones stand outside."""
    waypoints = np.array([[0, 0, 0], [10, 0, 0], [1000, 0, 0], [1010, 0, 0], [3000, 0, 0]], float)
    pads = choose_starts(
        waypoints, 3, [2500.0, 9000.0, 2500.0], 1, 10.0, hill, np.random.default_rng(0)
    )
    assert np.argmax(pads[:, 0]) == 1


def test_the_same_seed_gives_the_same_pads():
    """Choice is a function of its inputs and seed."""
    one, two = (
        choose_starts(scene(1), 4, np.full(8, 700.0), 2, 10.0, hill, np.random.default_rng(9))
        for _ in range(2)
    )
    assert one.tobytes() == two.tobytes()


@settings(deadline=None, derandomize=True, max_examples=40)
@given(st.integers(1, 40), st.floats(0, 30))
def test_pads_of_one_start_are_d_min_apart(fleet, d_min):
    """However many share a start, pads keep d_min and their middle is the start."""
    pads = place_pads(np.array([[100.0, -50.0]]), np.zeros(fleet, int), d_min, hill)
    distance = np.linalg.norm(pads[:, None] - pads[None], axis=-1) + 1e9 * np.eye(fleet)
    assert fleet == 1 or distance.min() >= d_min
    assert pads[:, :2].mean(axis=0) == pytest.approx([100, -50])


@settings(deadline=None, derandomize=True, max_examples=40)
@given(st.lists(st.integers(0, 100), min_size=1, max_size=8), st.integers(0, 20))
def test_shares_add_up_and_follow_sizes(sizes, extra):
    """Every start has a UAV, all are used, a larger cluster never has fewer."""
    shares = share_out(sizes, len(sizes) + extra)
    assert shares.sum() == len(sizes) + extra
    assert shares.min() >= 1
    for a in range(len(sizes)):
        for b in range(len(sizes)):
            if sizes[a] > sizes[b]:
                assert shares[a] >= shares[b]


def test_check_names_the_uav_that_is_worst_off_what_it_lacks_and_cures():
    """uav3 stands 500 m from uav1 with a mutual reach of 250 m: 250 m, 6.1 dB or K_min 1."""
    pads = np.array([[0.0, 0, 0], [100, 0, 0], [500, 0, 0], [290, 0, 0]])
    with pytest.raises(InfeasibleError) as caught:
        check_starts(pads, [250.0, 1000, 1000, 1000], 3, 10, names=["a", "b", "c", "d"])
    assert "a has 1 of 3 neighbours" in str(caught.value)
    assert "c is 500 m away and both reach 250 m, 250 m are lacking" in str(caught.value)
    assert caught.value.cures == (
        "starting points 250 m closer",
        "6.1 dB more power or antenna gain (in free space)",
        "K_min 1",
    )


def test_check_finds_pads_too_close_fleets_apart_and_k_min_too_large():
    """The other three ways to be infeasible at n = 0."""
    with pytest.raises(InfeasibleError, match=r"uav1 and uav3 start 4\.0 m apart"):
        check_starts(np.array([[0.0, 0, 0], [50, 0, 0], [0, 0, 4]]), np.full(3, 1e3), 1, 10)
    apart = np.array([[0.0, 0, 0], [50, 0, 0], [900, 0, 0], [950, 0, 0]])
    with pytest.raises(InfeasibleError, match=r"2 parts.*uav2 and uav3, 850 m apart"):
        check_starts(apart, np.full(4, 100.0), 1, 10)
    with pytest.raises(InfeasibleError, match="K_min is 4"):
        check_starts(apart, np.full(4, 1e4), 4, 10)


def test_hopeless_fleets_are_infeasible_not_looped():
    """Radios that do not even bridge two pads are answered with the lacking distance."""
    with pytest.raises(InfeasibleError, match="lacking") as caught:
        choose_starts(scene(1), 2, np.full(4, 5.0), 2, 10.0, hill, np.random.default_rng(0))
    assert caught.value.cures


@pytest.mark.parametrize("count", [0, 5])
def test_impossible_numbers_of_starts_are_refused(count):
    """Fewer than one start, or more than UAVs, is a wrong input."""
    with pytest.raises(InputError, match=r"starts\.count"):
        choose_starts(scene(1), count, np.full(4, 500.0), 2, 10.0, hill, np.random.default_rng(0))
