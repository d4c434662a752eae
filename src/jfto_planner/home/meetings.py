"""When two ways home may not be flown: differences of their departures at which they meet."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import Array, Flags
from jfto_planner.home.flown_way import FlownWay
from jfto_world.radio import pairwise_distances

# Beyond the least separation: what a sampled corner is off; nothing where both only rise or sink.
CORNER_M = 0.1
_STILL_M = 1e-3


def met(one: FlownWay, other: FlownWay, apart_m: float) -> tuple[Array, Array]:
    """Spans (M,), (M,) of `other`'s departure less `one`'s in which they come nearer than apart_m.

    Both hold at their first point before they leave and stand at their last after that; the ends of
    a span are infinite where one of them passes the other standing there.
    """
    (begin_a, move_a, from_a, to_a), (begin_b, move_b, from_b, to_b) = _pieces(one), _pieces(other)
    reach = 0.5 * (np.linalg.norm(move_a, axis=1)[:, None] + np.linalg.norm(move_b, axis=1))
    middle_a, middle_b = begin_a + 0.5 * move_a, begin_b + 0.5 * move_b
    places = np.concatenate([middle_a, middle_b])
    gap = pairwise_distances(places[None])[0][: len(middle_a), len(middle_a) :]
    i, j = np.nonzero(gap < apart_m + CORNER_M + reach)
    level = np.hypot(*move_a[i, :2].T) + np.hypot(*move_b[j, :2].T) > _STILL_M
    nearest = _between_pieces(begin_a[i], move_a[i], begin_b[j], move_b[j])
    close = nearest < apart_m + CORNER_M * level - _STILL_M
    i, j = i[close], j[close]
    return from_a[i] - to_b[j], to_a[i] - from_b[j]


def forbidden(spans: tuple[Array, Array], apart_s: float, begin_s: float, count: int) -> Flags:
    """Which of the differences begin_s + (-count … count), whole seconds, lie in spans.

    Spans are widened by `apart_s` at both ends.
    """
    first = np.ceil(spans[0] - apart_s - begin_s)
    last = np.floor(spans[1] + apart_s - begin_s)
    edges = np.zeros(2 * count + 2, dtype=np.int64)
    inside = (first <= count) & (last >= -count)
    begin = np.clip(first[inside], -count, count).astype(np.int64) + count
    end = np.clip(last[inside], -count, count).astype(np.int64) + count
    np.add.at(edges, begin, 1)
    np.add.at(edges, end + 1, -1)
    found: Flags = np.cumsum(edges)[:-1] > 0
    return found


def _pieces(way: FlownWay) -> tuple[Array, Array, Array, Array]:
    """Begin (P, 3), movement (P, 3) and times of straight pieces, hold and stand included."""
    move = np.diff(way.places_m, axis=0)
    still = np.zeros((1, 3))
    return (
        np.concatenate([way.places_m[:1], way.places_m]),
        np.concatenate([still, move, still]),
        np.concatenate([[-np.inf], way.at_s]),
        np.concatenate([way.at_s, [np.inf]]),
    )


def _between_pieces(begin_a: Array, move_a: Array, begin_b: Array, move_b: Array) -> Array:
    """Least distance between straight pieces (M, 3), piece by piece, (M,)."""
    apart = begin_a - begin_b
    aa, bb, ab = (_dot(*pair) for pair in ((move_a, move_a), (move_b, move_b), (move_a, move_b)))
    ca, cb = _dot(move_a, apart), _dot(move_b, apart)
    area = aa * bb - ab**2
    skew = area > 1e-9 * np.maximum(aa * bb, 1e-12)
    share = np.where(skew, np.clip(_over(ab * cb - ca * bb, area), 0.0, 1.0), 0.0)
    best = np.full(len(apart), np.inf)
    # The least lies inside, or at an end of one of them.
    for at_a in (share, np.zeros_like(share), np.ones_like(share)):
        at_b = np.clip(_over(ab * at_a + cb, bb), 0.0, 1.0)
        near_a = np.clip(_over(ab * at_b - ca, aa), 0.0, 1.0)
        for along in (at_a, near_a):
            gap = apart + along[:, None] * move_a - at_b[:, None] * move_b
            best = np.minimum(best, np.linalg.norm(gap, axis=1))
    for at_b in (np.zeros_like(share), np.ones_like(share)):
        at_a = np.clip(_over(ab * at_b - ca, aa), 0.0, 1.0)
        gap = apart + at_a[:, None] * move_a - at_b[:, None] * move_b
        best = np.minimum(best, np.linalg.norm(gap, axis=1))
    return best


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(np.einsum("mk,mk->m", a, b))


def _over(value: Array, by: Array) -> Array:
    return np.divide(value, by, out=np.zeros_like(value), where=by > 1e-12)
