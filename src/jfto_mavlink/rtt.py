"""Round-trip time of a link, and how long to wait for an answer (after RFC 6298)."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class RoundTrip:
    """Smoothed round-trip time in seconds and the time-out derived from it.

    `floor_s` covers the autopilot's own reaction (2 to 11 ms measured) and a busy computer.
    """

    smoothed_s: float | None = None
    variation_s: float = 0.0
    floor_s: float = 0.08
    ceiling_s: float = 2.0
    initial_s: float = 0.5

    def measure(self, sample_s: float) -> None:
        """Take in one measured round trip."""
        if sample_s < 0:
            return
        if self.smoothed_s is None:
            self.smoothed_s, self.variation_s = sample_s, sample_s / 2
            return
        self.variation_s += (abs(sample_s - self.smoothed_s) - self.variation_s) / 4
        self.smoothed_s += (sample_s - self.smoothed_s) / 8

    @property
    def timeout_s(self) -> float:
        """How long an answer may take before the question is asked again."""
        if self.smoothed_s is None:
            return self.initial_s
        wanted = self.smoothed_s + 4 * self.variation_s
        return min(max(wanted, self.floor_s), self.ceiling_s)
