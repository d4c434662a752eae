"""What to send to one vehicle next, or why to stop it. Knows no link and no clock."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto_mavlink.guided.curve_clock import Progress
from jfto_mavlink.guided.reference import Joining, Reference, reference
from jfto_msgs_py.records.vehicle import TimedTrajectory
from jfto_msgs_py.types import Array


@dataclass(frozen=True)
class GuidedSettings:
    """How a vehicle is streamed to, and when it is not any more.

    It hovers at `take_off_m` above its pad first; `departure_m` is how far from its pad a curve
    must be before it may lead below that height. A vehicle joins a curve up to `join_max_m` away
    and is stopped at `astray_max_m` from its target, if its position is at most `position_old_s`
    old: the stream itself goes on without positions, by its own clock. One without targets flies on
    at its last velocity until GUID_TIMEOUT (3 s): after a gap of `stalled_s` all are taken to
    stand. Who cannot go on holds for `hold_s`, then goes home.
    """

    rate_hz: float = 10.0
    position_old_s: float = 1.5
    stalled_s: float = 2.0
    join_max_m: float = 30.0
    astray_max_m: float = 25.0
    departure_m: float = 20.0
    take_off_m: float = 10.0
    hold_s: float = 5.0


@dataclass(frozen=True)
class Step:
    """A target to send, or a reason to stop for; neither while the curve has not begun."""

    target: Reference | None = None
    stop: str = ""


class Scheduler:
    """Turns a curve into targets for a vehicle that hovers at `hover_m` (ENU height) first.

    `halt` and `leave` may be called from another thread than `step`.
    """

    def __init__(self, settings: GuidedSettings, hover_m: float) -> None:
        self._settings = settings
        self._floor_m: float | None = hover_m
        self._followed: tuple[TimedTrajectory, int] | None = None
        self._joining: Joining | None = None
        self._last: Reference | None = None
        # What others have ordered meanwhile: to stop, or to be let alone.
        self.halted = self.left = ""

    def halt(self, reason: str) -> None:
        """Stop at the next step."""
        self.halted = self.halted or reason

    def leave(self, reason: str) -> None:
        """End at the next step without stopping the vehicle, which gets other orders."""
        self.left = reason

    def step(
        self,
        now_s: float,
        curve: TimedTrajectory,
        progress: Progress,
        here_m: Array,
        position_age_s: float,
    ) -> Step:
        """What to do now; `here_m` (3,) is where the vehicle was `position_age_s` ago."""
        if not progress.begun:
            return Step()
        ideal, raised = self._above_floor(_at(curve, progress), curve)
        fresh = position_age_s <= self._settings.position_old_s
        if self._followed != (curve, progress.joint):
            stands = self._last is None or self._followed is None or self._followed[0] is curve
            from_m = self._last.position_m if self._last is not None else here_m
            offset = (here_m if stands and fresh else from_m) - ideal.position_m
            away_m = float(np.linalg.norm(offset))
            if away_m > self._settings.join_max_m:
                return Step(stop=f"its trajectory is {away_m:.0f} m away")
            self._followed = (curve, progress.joint)
            self._joining = Joining.begin(now_s, offset)
        elif not raised and self._floor_m is not None:
            # From now on it may lead downward.
            assert self._last is not None
            self._floor_m = None
            self._joining = Joining.begin(now_s, self._last.position_m - ideal.position_m)
        target = ideal
        if self._joining is not None:
            target = self._joining.applied(ideal, now_s)
            if self._joining.over(now_s):
                self._joining = None
        astray_m = float(np.linalg.norm(here_m - target.position_m))
        if fresh and astray_m > self._settings.astray_max_m:
            return Step(stop=f"it is {astray_m:.0f} m from where it should be")
        self._last = target
        return Step(target)

    def _above_floor(self, ideal: Reference, curve: TimedTrajectory) -> tuple[Reference, bool]:
        """The reference, not below the hover height while it is still beside the pad."""
        floor_m = self._floor_m
        away = ideal.position_m[:2] - curve.position_m[0, :2]
        departed = float(np.hypot(away[0], away[1])) > self._settings.departure_m
        if floor_m is None or departed or ideal.position_m[2] >= floor_m:
            return ideal, False
        level = np.array([1.0, 1.0, 0.0])
        return (
            Reference(
                ideal.position_m * level + np.array([0.0, 0.0, floor_m]),
                ideal.velocity_mps * level,
                ideal.acceleration_mps2 * level,
            ),
            True,
        )


def _at(curve: TimedTrajectory, progress: Progress) -> Reference:
    """State on a curve that is flown at a rate: position, velocity, acceleration of a target."""
    at_ns = curve.start_ns + round(progress.elapsed_s * 1e9)
    found = reference(curve, np.array([at_ns]))
    velocity, rate = found.velocity_mps[0], progress.rate
    return Reference(
        found.position_m[0],
        velocity * rate,
        found.acceleration_mps2[0] * rate**2 + velocity * progress.growth,
    )
