"""A fleet on its curves: one progress for all, kept on disk, that survives gaps and restarts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from jfto_mavlink.guided.curve_clock import CurveClock, Progress
from jfto_mavlink.guided.curves import Curves
from jfto_mavlink.guided.held import GuidedState, HeldFlight
from jfto_mavlink.guided.scheduler import GuidedSettings
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.event import INFO, WARN, Event
from jfto_msgs_py.records.vehicle import TimedTrajectory
from jfto_msgs_py.types import Array

# How often it is written how far the flight is.
KEEP_EVERY_S = 1.0
# After a gap what the vehicles have sent meanwhile is read first.
SETTLE_S = 0.5
# A vehicle may be a little behind its target, and flies on a little after the last one.
BEFORE_S = 2.0
# Vehicles fly on for GUID_TIMEOUT without targets, and need a while to stop.
FLOWN_ON_S = 8.0


@dataclass(frozen=True)
class Surroundings:
    """What a guided flight gets from the bridge.

    `clock` (s) is the link's, `now_ns` the graph's time; `here_m` tells where those who are
    streamed to are (ENU, by UAV), `tell` is called in the link's thread.
    """

    clock: Callable[[], float]
    now_ns: Callable[[], int]
    here_m: Callable[[], Mapping[str, Array]]
    tell: Callable[[Event], None]


class GuidedFlight:
    """`progress` is called in the link's thread, `replace` and `keep` in any."""

    def __init__(
        self,
        curves: Curves,
        clock: CurveClock,
        zero_ns: int,
        settings: GuidedSettings,
        around: Surroundings,
        held: HeldFlight,
    ) -> None:
        self.curves, self.zero_ns = curves, zero_ns
        self._clock, self._settings, self._around, self._held = clock, settings, around, held
        self._newer: dict[str, TimedTrajectory] | None = None
        self._looked_s: float | None = None
        self._settled_s: float | None = None
        self._kept_s = float("-inf")
        self._trouble = ""

    def progress(self, now_s: float) -> Progress:
        """Where all are to be along their curves; after a gap they go on from where they stand."""
        looked_s, self._looked_s = self._looked_s, now_s
        gap_s = 0.0 if looked_s is None else now_s - looked_s
        found = self._clock.at(now_s)
        if gap_s > self._settings.stalled_s and found.begun and self._settled_s is None:
            assert looked_s is not None
            # Meanwhile nobody is sent anything.
            self._settled_s = now_s + SETTLE_S
            self._stalled_at = (self._clock.at(looked_s).elapsed_s, gap_s)
        if self._settled_s is not None:
            if now_s < self._settled_s:
                return Progress(found.elapsed_s, begun=False)
            self._settled_s = None
            elapsed_s, gap_s = self._stalled_at
            self.go_on(now_s, elapsed_s, f"nothing could be sent for {gap_s:.1f} s")
            found = self._clock.at(now_s)
        if self._newer is not None and found.begun:
            self._change_over(now_s, found.elapsed_s)
            found = self._clock.at(now_s)
        if now_s >= self._kept_s + KEEP_EVERY_S:
            self.keep()
        return found

    def curve(self, uav: str) -> TimedTrajectory:
        """What a UAV flies now."""
        return self.curves.held[uav]

    def elapsed_s(self) -> float | None:
        """How far along its curves the fleet is, None before time zero."""
        found = self._clock.at(self._around.clock())
        return found.elapsed_s if found.begun else None

    def stand(self, *, by_order: bool) -> None:
        """All are told to hold, by an operator's order or because the bridge ends."""
        self._clock.stand(self._around.clock())
        self.keep(paused=by_order)

    def go_on(self, now_s: float, stopped_s: float, why: str) -> dict[str, float]:
        """All go on from where they stand; `stopped_s` is how far they were told to be at last.

        Returns how far each is from its curve there, m.
        """
        here_m = self._around.here_m()
        elapsed_s, away_m = stopped_s, dict.fromkeys(here_m, 0.0)
        if here_m:
            elapsed_s, away_m = self.curves.standing_at(
                here_m, stopped_s - BEFORE_S, min(stopped_s + FLOWN_ON_S, self.curves.end_s)
            )
        self._clock.go_on(now_s, elapsed_s)
        self._looked_s = now_s
        late_s = self._clock.late_s(now_s)
        text = f"{why[:1].upper()}{why[1:]}: the fleet goes on {late_s:.1f} s later than planned."
        self._around.tell(Event(WARN, "late", "", text))
        return away_m

    def replace(self, newest: Mapping[str, TimedTrajectory]) -> None:
        """Fly other curves as soon as they begin."""
        self._newer = dict(newest)

    def _change_over(self, now_s: float, elapsed_s: float) -> None:
        assert self._newer is not None
        newer, now_ns = self._newer, self._around.now_ns()
        start_ns = next(iter(newer.values())).start_ns
        anew = start_ns != self.zero_ns
        if anew and start_ns > now_ns:
            return
        self._newer = None
        at_s = (now_ns - start_ns) / 1e9 if anew else elapsed_s
        other = Curves(tuple(newer), lambda _uav, _curve: None)
        other.hold(newer)
        away_m = {
            uav: float(np.linalg.norm(other.places(uav, np.array([at_s]))[0] - here_m))
            for uav, here_m in self._around.here_m().items()
        }
        far = {u: m for u, m in away_m.items() if m > self._settings.join_max_m}
        if far:
            named = ", ".join(f"{uav} by {m:.0f} m" for uav, m in far.items())
            text = f"The newer trajectories are too far away ({named}): those held are flown on."
            self._around.tell(Event(WARN, "guided", "", text))
            return
        self.curves.hold(newer)
        if anew:
            self._clock.begin_anew(now_s - at_s)
            self.zero_ns = start_ns
        self.keep_curves()
        self.keep()
        self._around.tell(Event(INFO, "guided", "", "Newer trajectories are flown from now on."))

    def keep_curves(self) -> None:
        """Write the curves that are flown."""
        self._written(lambda: self._held.keep_curves(self.curves.held))

    def keep(self, *, paused: bool = False, over: bool = False) -> None:
        """Write how far the flight is."""
        now_s = self._around.clock()
        self._kept_s = now_s
        state = GuidedState(
            self.zero_ns, self._around.now_ns(), self._clock.at(now_s).elapsed_s, paused, over
        )
        self._written(lambda: self._held.keep(state))

    def _written(self, write: Callable[[], None]) -> None:
        try:
            write()
        except InputError as error:
            if not self._trouble:
                text = f"{error} A bridge that is started again would not pick the flight up."
                self._around.tell(Event(WARN, "guided", "", text))
            self._trouble = str(error)
