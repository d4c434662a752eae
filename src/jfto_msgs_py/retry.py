"""How to try again what may fail and work the next time: one policy for all who do."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

# Further no wait grows, whatever its ceiling; more would overflow.
_GROWTHS_MAX = 64


@dataclass(frozen=True)
class Retry:
    """Waits (s) that grow from `first_s` by `factor` up to `ceiling_s`.

    Given up after `tries` tries, None: never, or where nothing has come for `limit_s`, which those
    who wait look after themselves.
    """

    first_s: float = 0.0
    ceiling_s: float = 2.0
    factor: float = 1.6
    tries: int | None = None
    limit_s: float = math.inf

    def wait_s(self, tried: int, first_s: float = 0.0) -> float | None:
        """Wait after so many tries (1, 2, …), None to give up.

        Waits begin with the greater of the policy's `first_s` and this one, such as a round trip.
        """
        if self.tries is not None and tried > self.tries:
            return None
        growth = self.factor ** min(tried - 1, _GROWTHS_MAX)
        return min(max(self.first_s, first_s) * growth, self.ceiling_s)

    def waits(self, first_s: float = 0.0) -> Iterator[float]:
        """One wait for each try."""
        tried = 1
        while (wait_s := self.wait_s(tried, first_s)) is not None:
            yield wait_s
            tried += 1

    def longer_s(self, wait_s: float) -> float:
        """The wait after one of `wait_s`."""
        return min(wait_s * self.factor, self.ceiling_s)
