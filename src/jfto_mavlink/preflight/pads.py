"""Where the vehicles of a fleet stand: each nearest to its own pad, and at its height."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from statistics import median_high, median_low

from jfto_mavlink.preflight.page import AMBER, GREEN, RED, Finding
from jfto_mavlink.protocol.item import distance_m

Place = tuple[float, float, float]
# Of the distance to the nearest other pad: less than half, so that no two can be taken for
# one another.
PAD_SHARE = 0.45
# Heights above sea level and of an elevation model above the ellipsoid are up to 107 m apart.
DATUM_M, UNUSUAL_M = 110.0, 25.0
# Between vehicles that all tell heights of one kind; GPS is worse upward.
APART_M = 12.0


def pads(
    homes: Mapping[str, Place], places: Mapping[str, Place | None], distance_max_m: float
) -> dict[str, tuple[Finding, ...]]:
    """Findings by UAV. `homes` are the planned pads, `places` where they say they stand.

    Both are degrees, degrees and metres, None where a vehicle does not know it.
    """
    known = {uav: place for uav, place in places.items() if place is not None}
    above = {uav: place[2] - homes[uav][2] for uav, place in known.items()}
    middle = [median_low(above.values()), median_high(above.values())] if above else [0.0]
    datum_m = min(middle, key=abs)
    return {
        uav: tuple(_of_one(uav, homes, places.get(uav), distance_max_m, datum_m)) for uav in homes
    }


def _of_one(
    uav: str,
    homes: Mapping[str, Place],
    place: Place | None,
    distance_max_m: float,
    datum_m: float,
) -> Iterator[Finding]:
    if place is None:
        cure = "It is held against its pad before it is armed."
        yield Finding("pad", AMBER, "where it stands is not known yet", cure)
        return
    away = {other: _level_m(place, home) for other, home in homes.items()}
    nearest = min(away, key=lambda other: away[other])
    others = [_level_m(homes[uav], home) for other, home in homes.items() if other != uav]
    limit_m = min([distance_max_m, *(PAD_SHARE * apart for apart in others)])
    own_m = away[uav]
    cure = "Put it on its pad, or change the roster."
    above_m = place[2] - homes[uav][2]
    if nearest != uav and away[nearest] < own_m:
        text = f"stands {own_m:.1f} m from its planned pad and {away[nearest]:.1f} m from "
        yield Finding("pad", RED, f"{text}that of {nearest}", cure)
    elif own_m > limit_m:
        text = f"stands {own_m:.{0 if own_m >= 10 else 1}f} m from its planned pad"
        yield Finding("pad", RED, f"{text}, at most {limit_m:.1f} m", cure)
    elif abs(above_m) > DATUM_M:
        text = f"stands {above_m:+.0f} m above its planned pad"
        yield Finding("pad", RED, text, "Look at the plan's origin and heights, or plan anew.")
    elif abs(above_m - datum_m) > APART_M:
        text = f"stands {above_m - datum_m:+.0f} m higher against its pad than the others do"
        yield Finding("pad", RED, text, cure)
    elif abs(above_m) > UNUSUAL_M:
        text = f"on its pad; its height is {above_m:+.0f} m off the plan's"
        yield Finding("pad", AMBER, text, "Make sure that only the height's datum differs.")
    else:
        yield Finding("pad", GREEN, f"on its pad: {own_m:.1f} m, {above_m:+.1f} m in height")


def _level_m(a: Place, b: Place) -> float:
    return distance_m((*a[:2], 0.0), (*b[:2], 0.0))
