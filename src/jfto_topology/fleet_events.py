"""Events of the fleet: who sends no poses, runs late, left its route; once each, and its end."""

from __future__ import annotations

from jfto_msgs_py.core import Episodes
from jfto_msgs_py.records.event import ERROR, INFO, WARN, Event
from jfto_topology.horizon import HorizonTopology
from jfto_world.motion.fleet_prediction import FleetPrediction

# So much later than its fleet a UAV is told of; less late again than that it is over.
LATE_S = 10.0
_LATE_OVER_S = 7.0
# Shifts of the slots are told in steps of so much, or of a slot where that is longer.
_SHIFT_S = 5.0


class FleetEvents:
    """Turns what each slot was solved from into events."""

    def __init__(self, prediction: FleetPrediction) -> None:
        self._prediction = prediction
        self._stale: Episodes[str] = Episodes()
        self._late: Episodes[str] = Episodes()
        self._off: Episodes[str] = Episodes()
        self._blind: Episodes[str] = Episodes()
        self._told_shift_s = 0.0

    def of_slot(self, solved: HorizonTopology, now_ns: int) -> list[Event]:
        """Events after a slot was solved at `now_ns`."""
        return [
            *self._of_silence(solved, now_ns),
            *self._of_routes(solved),
            *self._of_shift(solved),
        ]

    def _of_silence(self, solved: HorizonTopology, now_ns: int) -> list[Event]:
        events: list[Event] = []
        began, over = self._blind.update(["blind"] if solved.blind else [])
        if began:
            text = "Hardly a UAV is heard: the topology goes on from their last good predictions."
            events.append(Event(ERROR, "stale", "", text))
        if over:
            events.append(
                Event(INFO, "stale", "", "UAVs are heard again: the topology follows them.")
            )
        if solved.blind:
            return events
        began, over = self._stale.update(solved.excluded)
        for uav in began:
            stamp_ns = self._prediction.pose_stamp_ns(uav)
            since = "yet" if stamp_ns is None else f"for {(now_ns - stamp_ns) / 1e9:.1f} s"
            text = f"No pose of {uav} {since}: left out of the topology until it is heard."
            events.append(Event(WARN, "stale", uav, text))
        events += [
            Event(INFO, "stale", uav, f"{uav} is heard, and part of the topology.") for uav in over
        ]
        return events

    def _of_routes(self, solved: HorizonTopology) -> list[Event]:
        events: list[Event] = []
        uav_ids, fleet_s = solved.adjacency.uav_ids, solved.lag_s or 0.0
        off = [uav for uav in uav_ids if self._prediction.is_off_route(uav)]
        late_s = {
            uav: self._prediction.lag_s(uav) - fleet_s
            for uav in uav_ids
            if solved.lag_s is not None and uav not in off and not self._prediction.is_done(uav)
        }
        late = [
            uav
            for uav, lag_s in late_s.items()
            if lag_s > (_LATE_OVER_S if uav in self._late else LATE_S)
        ]
        began, over = self._off.update(off)
        for uav in began:
            text = f"{uav} has left its route: it is reckoned with where it is measured."
            events.append(Event(WARN, "late", uav, text))
        events += [
            Event(INFO, "late", uav, f"{uav} no longer strays from its route.") for uav in over
        ]
        began, over = self._late.update(late)
        for uav in began:
            text = f"{uav} runs {late_s[uav]:.0f} s later than the fleet: it is predicted so."
            events.append(Event(WARN, "late", uav, text))
        events += [
            Event(INFO, "late", uav, f"{uav} no longer lags behind the fleet.") for uav in over
        ]
        return events

    def _of_shift(self, solved: HorizonTopology) -> list[Event]:
        step_s = max(_SHIFT_S, solved.adjacency.horizon.duration_s)
        if abs(solved.shift_s - self._told_shift_s) < step_s:
            return []
        self._told_shift_s = solved.shift_s
        how = "late" if solved.shift_s >= 0 else "early"
        text = (
            f"The fleet runs {abs(solved.shift_s):.0f} s {how}: its slots are shifted by as much."
        )
        return [Event(INFO, "late", "", text)]
