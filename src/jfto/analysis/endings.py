"""How each UAV's flight ended."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto.analysis.grid import GAP_S
from jfto.analysis.record import RecordedFlight, Track
from jfto_msgs_py.records.plan import Plan

LANDED, AIRBORNE, LOST, UNSEEN = "landed", "still in the air", "lost", "never seen"
# On its pad a UAV is this near, and this low.
_PAD_M, _GROUND_M = 8.0, 1.5
# Higher above the pad than any noise, lower than every take-off.
_RISEN_M = 5.0
_STEP_S = 0.5


@dataclass(frozen=True)
class Ending:
    """`how` is one of the words above; `last_s` the time of the last pose after lift-off.

    `return_gap_m` is the least distance to another UAV in the air after the mission, inf where
    there was none.
    """

    uav: str
    how: str
    last_s: float
    return_gap_m: float


def endings_of(flight: RecordedFlight, plan: Plan, end_s: float) -> tuple[Ending, ...]:
    """The end of every UAV of the plan; `end_s` is when the fleet was done."""
    last_s = flight.last_s
    said = {event.uav_id: event.text for event in flight.events if event.kind == "landed"}
    gaps = _return_gaps(flight, plan, end_s, last_s)
    found = []
    for index, uav in enumerate(plan.uavs):
        track = flight.tracks[uav.id]
        if not track.times_s.size:
            found.append(Ending(uav.id, UNSEEN, float("nan"), float("inf")))
            continue
        offset = track.position_m[-1] - np.array(uav.start_m)
        down = np.linalg.norm(offset[:2]) < _PAD_M and offset[2] < _GROUND_M
        how = AIRBORNE if last_s - track.times_s[-1] <= GAP_S else LOST
        if f"{uav.id} declared lost" in said.get("", ""):
            how = LOST
        elif uav.id in said or "" in said or down:
            how = LANDED
        found.append(Ending(uav.id, how, float(track.times_s[-1]), gaps[index]))
    return tuple(found)


def left_the_ground(flight: RecordedFlight, plan: Plan) -> bool:
    """Whether any UAV was seen above its pad."""
    tracks = [(flight.tracks[uav.id], uav.start_m[2]) for uav in plan.uavs]
    return any(bool((t.position_m[:, 2] - up_m > _RISEN_M).any()) for t, up_m in tracks)


def _return_gaps(flight: RecordedFlight, plan: Plan, end_s: float, last_s: float) -> list[float]:
    times = np.arange(end_s, last_s, _STEP_S)
    if not times.size:
        return [float("inf")] * len(plan.uavs)
    places = np.stack([_in_the_air(flight.tracks[u.id], u.start_m[2], times) for u in plan.uavs])
    apart = np.linalg.norm(places[:, None] - places[None, :], axis=3)
    apart[np.arange(len(apart)), np.arange(len(apart))] = np.inf
    return [float(each) for each in np.where(np.isnan(apart), np.inf, apart).min(axis=(1, 2))]


def _in_the_air(track: Track, pad_up_m: float, times_s: np.ndarray) -> np.ndarray:
    """Places (T, 3), nan where the UAV stands, or is not known to be."""
    places = track.at(times_s)
    if track.times_s.size:
        gone = times_s > track.times_s[-1]
        places[gone | (places[:, 2] - pad_up_m < _GROUND_M)] = np.nan
    return places
