"""The vehicle's clocks: simulated time, time since power-up, UTC."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class Clock:
    """`total_s` counts from when the vehicle was made, `time_s` from its last power-up.

    `utc_at_boot_us` is UTC at the last power-up; `drift_ppm` makes the vehicle's own clock, and
    with it all but `total_s`, run fast.
    """

    utc_at_boot_us: int
    drift_ppm: float
    total_s: float = 0.0
    time_s: float = 0.0

    def restart(self, dark_s: float) -> None:
        """Power up again after `dark_s` seconds."""
        self.utc_at_boot_us += round((self.time_s + dark_s) * 1e6)
        self.time_s = 0.0

    @property
    def time_us(self) -> int:
        """Microseconds since power-up."""
        return round(self.time_s * 1e6)

    @property
    def time_ms(self) -> int:
        """Milliseconds since power-up."""
        return int(self.time_s * 1e3 + 1e-6)

    @property
    def utc_us(self) -> int:
        """UTC in microseconds."""
        return self.utc_at_boot_us + self.time_us

    def seconds_until_utc(self, hour: float, minute: float, second: float) -> float:
        """Seconds until a time of day; -1 means any; a time just past waits for the next one."""
        now = self.utc_us / 1e6 % 86400.0
        clock = (int(now // 3600), int(now // 60) % 60, now % 60.0)
        if hour >= 0:
            wanted, span = hour * 3600 + max(minute, 0) * 60 + max(second, 0), 86400.0
            return (wanted - now) % span
        if minute >= 0:
            return float((minute * 60 + max(second, 0) - clock[1] * 60 - clock[2]) % 3600.0)
        if second >= 0:
            return float((second - clock[2]) % 60.0)
        return 0.0
