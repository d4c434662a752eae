"""When a mission's camera takes photos: by distance, by time, or one by one."""

from __future__ import annotations

import math
from collections.abc import Iterator

from jfto_msgs_py.errors import WaypointError
from jfto_msgs_py.mission_file import FileItem
from jfto_planner.coverage.places import Spot

# MAV_CMD numbers (mavlink.io, common.xml).
_DIGICAM_CONTROL, _TRIGGER_DISTANCE, _TRIGGER_INTERVAL = 203, 206, 214
_START_CAPTURE, _STOP_CAPTURE = 2000, 2001
# Coordinates in files are rounded: the end of a line still counts for its last photo.
_SLACK_M = 0.02
_MOST_PHOTOS = 100_000


class PhotoTrigger:
    """The state of the trigger as items change it.

    `used` is whether any item so far takes photos; `shoots_now` whether one is due where the
    vehicle is, before it flies on.
    """

    COMMANDS = (
        _DIGICAM_CONTROL,
        _TRIGGER_DISTANCE,
        _TRIGGER_INTERVAL,
        _START_CAPTURE,
        _STOP_CAPTURE,
    )

    def __init__(self) -> None:
        self.speed_mps: float | None = None
        self.used = False
        self._every_m = 0.0
        self._every_s = 0.0
        self._due_m = math.inf
        self._left = math.inf
        self._single = False
        self._count = 0

    @property
    def active(self) -> bool:
        """Whether photos are taken along the way."""
        return (self._every_m > 0 or self._every_s > 0) and self._left > 0

    @property
    def shoots_now(self) -> bool:
        """Whether a photo is due; asking takes it."""
        single, self._single = self._single, False
        return single

    @property
    def due_here(self) -> bool:
        """Whether the first photo of a row is due before the vehicle flies on."""
        return self.active and self._due_m == 0

    def take(self, item: FileItem) -> bool:
        """Whether an item is one of the camera, which then changes the trigger."""
        first, second, third = item.params[:3]
        if item.command == _DIGICAM_CONTROL:
            self._single = item.params[4] == 1
        elif item.command == _TRIGGER_DISTANCE:
            self._start(max(first, 0.0), 0.0, at_once=third == 1)
        elif item.command == _TRIGGER_INTERVAL:
            self._start(0.0, max(first, 0.0) / 1000, at_once=False)
        elif item.command == _START_CAPTURE:
            if third == 1 or second <= 0:
                self._single = True
            else:
                self._start(0.0, second, at_once=True, count=third if third > 0 else math.inf)
        elif item.command == _STOP_CAPTURE:
            self._start(0.0, 0.0, at_once=False)
        else:
            return False
        self.used = self.used or self._single or self.active
        return True

    def _start(
        self, every_m: float, every_s: float, *, at_once: bool, count: float = math.inf
    ) -> None:
        self._every_m, self._every_s, self._left = every_m, every_s, count
        # None of a distance known yet: after one of them, or where it begins.
        self._due_m = 0.0 if at_once else -1.0

    def along(self, place: str, start: Spot | None, end: Spot) -> Iterator[float]:
        """Shares (0 to 1) of the leg from `start` to `end` at which photos are taken.

        Without a known start only what is due at the end is taken. Raises WaypointError.
        """
        if not self.active:
            return
        every_m = self._spacing(place)
        if self._due_m < 0:
            self._due_m = every_m
        if start is None:
            if self._due_m == 0:
                yield 1.0
                self._due_m, self._left = every_m, self._left - 1
            return
        length_m = math.dist(start.position_m[:2], end.position_m[:2])
        while self._due_m <= length_m + _SLACK_M and self._left > 0:
            self._count += 1
            if self._count > _MOST_PHOTOS:
                raise WaypointError(
                    f"{place}: with a photo every {every_m:g} m the file has more than "
                    f"{_MOST_PHOTOS} photos. Trigger the camera at a greater distance."
                )
            yield min(self._due_m / length_m, 1.0) if length_m > 0 else 1.0
            self._due_m += every_m
            self._left -= 1
        self._due_m = max(self._due_m - length_m, every_m * 1e-9)

    def _spacing(self, place: str) -> float:
        if self._every_m > 0:
            return self._every_m
        if not self.speed_mps:
            raise WaypointError(
                f"{place}: its camera takes a photo every {self._every_s:g} s, but the file names "
                "no speed. Trigger it by distance (206), or put a speed (178) before it."
            )
        return self._every_s * self.speed_mps
