"""How long to wait before a process that has died is started again."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class BackOffSettings:
    """First wait, greatest wait, and the uptime (s) after which a process counts as sound.

    A process that dies `give_up_after` times without having become sound is given up.
    """

    first_s: float = 0.1
    greatest_s: float = 5.0
    sound_after_s: float = 3.0
    give_up_after: int = 8


class BackOff:
    """Waits that double with every death, until a process has been up long enough."""

    def __init__(self, settings: BackOffSettings) -> None:
        self._settings = settings
        self._deaths = 0

    def wait_s(self, uptime_s: float) -> float | None:
        """Wait after a death `uptime_s` after the start; None to give the process up."""
        settings = self._settings
        self._deaths = 1 if uptime_s >= settings.sound_after_s else self._deaths + 1
        if self._deaths > settings.give_up_after:
            return None
        wait_s = settings.first_s * 2.0 ** (self._deaths - 1)
        return float(min(wait_s, settings.greatest_s))
