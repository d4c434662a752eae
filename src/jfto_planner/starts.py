"""Where the fleet takes off: starting points near the work, and within reach of one another."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse.csgraph import connected_components

from jfto_msgs_py.errors import InfeasibleError, InputError
from jfto_msgs_py.types import Array, GroundHeight, Ints
from jfto_world.radio import degrees, pairwise_distances

# Pads are laid out a little further apart than asked, and starts chosen a little closer than the
# radios reach, so that rounding and wind on the pad do not undo either.
_PAD_SLACK = 1.05
_REACH_SLACK = 0.99
_LEAST_PAD_SPACING_M = 1.0
_KMEANS_TRIES = 8
_KMEANS_ROUNDS = 100
_SHRINK_STEPS = 200


def choose_starts(
    waypoints_m: Array,
    start_count: int,
    reach_m: ArrayLike,
    k_min: int,
    d_min_m: float,
    ground_height: GroundHeight,
    rng: np.random.Generator,
) -> Array:
    """Pads (A, 3) on the ground at `start_count` points chosen from the waypoints (W, 3).

    The points are the centres of k-means clusters of the waypoints on the map; UAVs are shared
    out in proportion to the clusters' sizes, those with the longest `reach_m` (A,) to the
    outermost. All are then drawn towards their middle as little as gives every UAV `k_min`
    neighbours and the fleet one component. `ground_height(x, y)` gives z in metres.

    Raises InputError for impossible counts, InfeasibleError where no such pads exist.
    """
    reach = np.asarray(reach_m, dtype=np.float64)
    fleet = len(reach)
    if not 1 <= start_count <= min(fleet, len(waypoints_m)):
        raise InputError(
            f"starts.count is {start_count}, must be between 1 and the number of UAVs, {fleet}, "
            f"and of waypoints, {len(waypoints_m)}."
        )
    centres, sizes = _kmeans(np.asarray(waypoints_m)[:, :2], start_count, rng)
    start_of = _assign(centres, share_out(sizes, fleet), reach)
    middle = np.average(centres[start_of], axis=0)
    for step in range(_SHRINK_STEPS):
        shrunk = middle + (1 - step / _SHRINK_STEPS) * (centres - middle)
        pads = place_pads(shrunk, start_of, d_min_m, ground_height)
        if _holds(pads, reach * _REACH_SLACK, k_min, d_min_m):
            return pads
    together = np.zeros(fleet, dtype=np.int64)
    pads = place_pads(middle[None, :], together, d_min_m, ground_height)
    check_starts(pads, reach, k_min, d_min_m)
    return pads


def check_starts(
    pads_m: Array,
    reach_m: ArrayLike,
    k_min: int,
    d_min_m: float,
    names: Sequence[str] | None = None,
) -> None:
    """Raise InfeasibleError unless n = 0 keeps all rules with the UAVs on pads (A, 3).

    The rules: pads d_min apart; every UAV with K_min neighbours within mutual reach at P_max; the
    fleet in one component. The message names the UAV that is worst off, what it lacks, and cures.
    """
    reach = np.asarray(reach_m, dtype=np.float64)
    fleet = len(reach)
    if np.shape(pads_m) != (fleet, 3):
        raise InputError(f"Pads have shape {np.shape(pads_m)}, must be ({fleet}, 3).")
    names = names or [f"uav{number + 1}" for number in range(fleet)]
    if k_min >= fleet:
        raise InfeasibleError(
            f"K_min is {k_min}, but each of {fleet} UAVs has only {fleet - 1} others.",
            cures=(f"K_min {fleet - 1} or less", f"{k_min + 1 - fleet} more UAVs"),
        )
    distance = pairwise_distances(np.asarray(pads_m, dtype=np.float64))
    mutual_m = np.minimum(reach[:, None], reach[None, :])
    _check_separation(distance, d_min_m, names)
    _check_neighbours(distance, mutual_m, k_min, names)
    _check_connected(distance, mutual_m, names)


def place_pads(
    starts_m: Array, start_of: ArrayLike, d_min_m: float, ground_height: GroundHeight
) -> Array:
    """Pads (A, 3) on the ground for UAVs that share starting points `starts_m` (S, 2).

    `start_of` (A,) is each UAV's start. Pads of one start form a square grid about it.
    """
    starts = np.asarray(starts_m, dtype=np.float64)
    start_of = np.asarray(start_of, dtype=np.int64)
    spacing = max(d_min_m * _PAD_SLACK, _LEAST_PAD_SPACING_M)
    place = np.empty((len(start_of), 2))
    for start in range(len(starts)):
        users = np.flatnonzero(start_of == start)
        place[users] = starts[start, :2] + spacing * _square_grid(len(users))
    return np.column_stack([place, ground_height(place[:, 0], place[:, 1])])


def share_out(sizes: ArrayLike, fleet: int) -> Ints:
    """UAVs per start (S,): one each, the rest in proportion to the clusters' sizes (S,).

    Largest deficit first (the Sainte-Laguë rule), ties to the lower index.
    """
    weight = np.asarray(sizes, dtype=np.float64)
    shares = np.ones(len(weight), dtype=np.int64)
    for _ in range(fleet - len(weight)):
        shares[int(np.argmax(weight / (2 * shares + 1)))] += 1
    return shares


def _square_grid(count: int) -> Array:
    """`count` points of a square grid of unit spacing, centred on the origin; (count, 2)."""
    side = math.ceil(math.sqrt(count))
    grid = np.array([(k % side, k // side) for k in range(count)], dtype=np.float64)
    return grid.reshape(count, 2) - (grid.mean(axis=0) if count else 0.0)


def _assign(centres: Array, shares: Ints, reach: Array) -> Ints:
    """Start of each UAV: the longest reach to the start furthest from the middle."""
    outward = np.linalg.norm(centres - np.average(centres, axis=0, weights=shares), axis=1)
    starts = np.argsort(-np.round(outward, 3), kind="stable")
    uavs = np.argsort(-reach, kind="stable")
    start_of = np.empty(len(reach), dtype=np.int64)
    start_of[uavs] = np.repeat(starts, shares[starts])
    return start_of


def _kmeans(points: Array, count: int, rng: np.random.Generator) -> tuple[Array, Array]:
    """Centres (S, 2) and sizes (S,) of the best of several Lloyd runs from k-means++ seeds."""
    best_cost, best = math.inf, (points[:count], np.ones(count))
    for _ in range(_KMEANS_TRIES):
        centres = _seeds(points, count, rng)
        for _ in range(_KMEANS_ROUNDS):
            squared = ((points[:, None, :] - centres[None, :, :]) ** 2).sum(axis=-1)
            label = np.argmin(squared, axis=1)
            moved = np.array(
                [
                    points[label == k].mean(axis=0) if (label == k).any() else centres[k]
                    for k in range(count)
                ]
            )
            if np.array_equal(moved, centres):
                break
            centres = moved
        cost = float(squared.min(axis=1).sum())
        if cost < best_cost:
            best_cost, best = cost, (centres, np.bincount(label, minlength=count).astype(float))
    order = np.lexsort((best[0][:, 1], best[0][:, 0]))
    return best[0][order], best[1][order]


def _seeds(points: Array, count: int, rng: np.random.Generator) -> Array:
    chosen = [int(rng.integers(len(points)))]
    for _ in range(count - 1):
        squared = ((points[:, None, :] - points[chosen][None, :, :]) ** 2).sum(axis=-1).min(axis=1)
        total = float(squared.sum())
        weights = squared / total if total > 0 else None
        chosen.append(int(rng.choice(len(points), p=weights)))
    return points[chosen].copy()


def _holds(pads_m: Array, reach: Array, k_min: int, d_min_m: float) -> bool:
    try:
        check_starts(pads_m, reach, k_min, d_min_m)
    except InfeasibleError:
        return False
    return True


def _check_separation(distance: Array, d_min_m: float, names: Sequence[str]) -> None:
    apart = distance + np.where(np.eye(len(distance), dtype=bool), np.inf, 0.0)
    a, b = divmod(int(np.argmin(apart)), len(apart))
    if apart[a, b] < d_min_m:
        raise InfeasibleError(
            f"{names[a]} and {names[b]} start {apart[a, b]:.1f} m apart, must be {d_min_m:g} m: "
            f"{d_min_m - apart[a, b]:.1f} m are lacking.",
            cures=("starting points further apart", "fewer UAVs per starting point"),
        )


def _check_neighbours(distance: Array, mutual_m: Array, k_min: int, names: Sequence[str]) -> None:
    if k_min < 1:
        return
    excess = distance - mutual_m
    excess[np.arange(len(excess)), np.arange(len(excess))] = np.inf
    neighbours = degrees(excess <= 0)
    # What each UAV lacks on the way to its K_min-th neighbour; ≤ 0 where it has it.
    order = np.argsort(excess, axis=1, kind="stable")
    needed = order[:, k_min - 1]
    lacking = excess[np.arange(len(excess)), needed]
    worst = int(np.argmax(lacking))
    if lacking[worst] <= 0:
        return
    other = int(needed[worst])
    others = int((lacking > 0).sum()) - 1
    has, far_m, reach_m = int(neighbours[worst]), distance[worst, other], mutual_m[worst, other]
    raise InfeasibleError(
        f"{names[worst]} has {has} of {k_min} neighbours at its start: {names[other]} is "
        f"{far_m:.0f} m away and both reach {reach_m:.0f} m, {lacking[worst]:.0f} m are lacking"
        + (f" ({others} more UAVs lack some)." if others else "."),
        cures=_cures(far_m, reach_m, f"K_min {has}" if has else ""),
    )


def _check_connected(distance: Array, mutual_m: Array, names: Sequence[str]) -> None:
    count, label = connected_components(distance <= mutual_m, directed=False)
    if count == 1:
        return
    excess = np.where(label[:, None] != label[None, :], distance - mutual_m, np.inf)
    a, b = divmod(int(np.argmin(excess)), len(excess))
    raise InfeasibleError(
        f"The fleet starts in {count} parts that do not hear one another: nearest are {names[a]} "
        f"and {names[b]}, {distance[a, b]:.0f} m apart with a reach of {mutual_m[a, b]:.0f} m, "
        f"{excess[a, b]:.0f} m are lacking.",
        cures=_cures(distance[a, b], mutual_m[a, b], ""),
    )


def _cures(far_m: float, reach_m: float, further: str) -> tuple[str, ...]:
    cures = [f"starting points {math.ceil(far_m - reach_m)} m closer"]
    if reach_m > 0:
        decibels = math.ceil(200 * math.log10(far_m / reach_m)) / 10
        cures.append(f"{decibels:.1f} dB more power or antenna gain (in free space)")
    return (*cures, further) if further else tuple(cures)
