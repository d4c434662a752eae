"""What to send to one vehicle next, or why to stop it. Knows no link and no clock."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto_mavlink.guided.reference import Joining, Reference, reference
from jfto_msgs_py.records.vehicle import TimedTrajectory
from jfto_msgs_py.types import Array


@dataclass(frozen=True)
class GuidedSettings:
    """When a stream is good enough to go on.

    A vehicle without targets flies on at its last velocity until GUID_TIMEOUT (3 s); all waiting
    times together must stay below. It hovers at `take_off_m` above its pad first; `departure_m` is
    how far from its pad a trajectory must be before it may lead below that height.
    """

    rate_hz: float = 10.0
    source_silent_max_s: float = 1.0
    position_silent_max_s: float = 1.5
    stalled_max_s: float = 1.0
    join_max_m: float = 30.0
    astray_max_m: float = 25.0
    departure_m: float = 20.0
    take_off_m: float = 10.0


@dataclass(frozen=True)
class Step:
    """A target to send, or a reason to stop for; neither while the trajectory has not begun.

    With `leave` the vehicle is in other hands already and must not be stopped.
    """

    target: Reference | None = None
    stop: str = ""
    leave: bool = False


class Scheduler:
    """Turns a trajectory into targets for a vehicle that hovers at `hover_m` (ENU height) first.

    `take` and `confirm` may be called from another thread than `step`.
    """

    def __init__(self, settings: GuidedSettings, hover_m: float) -> None:
        self._settings = settings
        self._floor_m: float | None = hover_m
        self._trajectory: TimedTrajectory | None = None
        self._followed: TimedTrajectory | None = None
        self._joining: Joining | None = None
        self._last: Reference | None = None
        self._stepped_s: float | None = None
        self._confirmed_s = float("-inf")
        self._halt = ""
        self._leave = ""

    def take(self, trajectory: TimedTrajectory, now_s: float) -> None:
        """A trajectory has come; a new one replaces the one being flown."""
        self._trajectory = trajectory
        self.confirm(now_s)

    def confirm(self, now_s: float) -> None:
        """Whoever makes the trajectory is still there."""
        self._confirmed_s = now_s

    def halt(self, reason: str) -> None:
        """Stop at the next step."""
        self._halt = self._halt or reason

    def leave(self, reason: str) -> None:
        """End at the next step without stopping the vehicle, which gets other orders."""
        self._leave = reason

    def step(self, now_s: float, now_ns: int, here_m: Array, position_age_s: float) -> Step:
        """What to do now; `here_m` (3,) is where the vehicle was `position_age_s` ago."""
        if self._leave:
            return Step(stop=self._leave, leave=True)
        stop = self._reason_to_stop(now_s, now_ns, position_age_s)
        self._stepped_s = now_s
        trajectory = self._trajectory
        if stop or trajectory is None:
            return Step(stop=stop)
        if now_ns < trajectory.start_ns:
            return Step()
        wanted = reference(trajectory, np.array([now_ns]))
        ideal = Reference(wanted.position_m[0], wanted.velocity_mps[0], wanted.acceleration_mps2[0])
        ideal, raised = self._above_floor(ideal, trajectory)
        if trajectory is not self._followed:
            offset = (here_m if self._last is None else self._last.position_m) - ideal.position_m
            away_m = float(np.linalg.norm(offset))
            if away_m > self._settings.join_max_m:
                return Step(stop=f"its trajectory is {away_m:.0f} m away")
            self._followed, self._joining = trajectory, Joining.begin(now_s, offset)
        elif not raised and self._floor_m is not None:
            # From now on it may lead downward.
            assert self._last is not None
            self._floor_m = None
            offset = self._last.position_m - ideal.position_m
            self._joining = Joining.begin(now_s, offset)
        target = ideal
        if self._joining is not None:
            target = self._joining.applied(ideal, now_s)
            if self._joining.over(now_s):
                self._joining = None
        astray_m = float(np.linalg.norm(here_m - target.position_m))
        if astray_m > self._settings.astray_max_m:
            return Step(stop=f"it is {astray_m:.0f} m from where it should be")
        self._last = target
        return Step(target)

    def _reason_to_stop(self, now_s: float, now_ns: int, position_age_s: float) -> str:
        limits, trajectory = self._settings, self._trajectory
        silent_s = now_s - self._confirmed_s
        stalled_s = 0.0 if self._stepped_s is None else now_s - self._stepped_s
        over = trajectory is not None and now_ns > trajectory.start_ns + int(
            trajectory.offset_ns[-1]
        )
        reasons = (
            (bool(self._halt), self._halt),
            (trajectory is None, "there is no trajectory"),
            (over, "its trajectory has ended"),
            (
                silent_s > limits.source_silent_max_s,
                f"the source of its trajectory is silent for {silent_s:.1f} s",
            ),
            (stalled_s > limits.stalled_max_s, f"the stream stalled for {stalled_s:.1f} s"),
            (
                position_age_s > limits.position_silent_max_s,
                f"no position for {position_age_s:.1f} s",
            ),
        )
        return next((text for wrong, text in reasons if wrong), "")

    def _above_floor(self, ideal: Reference, trajectory: TimedTrajectory) -> tuple[Reference, bool]:
        """The reference, not below the hover height while it is still beside the pad."""
        floor_m = self._floor_m
        away = ideal.position_m[:2] - trajectory.position_m[0, :2]
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
