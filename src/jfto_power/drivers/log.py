"""A driver that only writes what would be set: for rehearsals, and radios set by others."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from jfto_power.drivers.driver import RadioError, check_power, check_served


class LogDriver:
    """Writes a line per power set, and reads back the last one."""

    def __init__(self, uav_ids: Sequence[str], write: Callable[[str], None]) -> None:
        self._served = tuple(uav_ids)
        self._write = write
        self._set_dbm: dict[str, float] = {}

    def apply(self, uav_id: str, dbm: float) -> float:
        """Write the line."""
        check_power(uav_id, dbm, self._served)
        self._write(f"{uav_id}: tx power {dbm:.2f} dBm")
        self._set_dbm[uav_id] = dbm
        return dbm

    def read(self, uav_id: str) -> float:
        """The last power written; raises RadioError before the first."""
        check_served(uav_id, self._served)
        if uav_id not in self._set_dbm:
            raise RadioError(f"{uav_id}: no power was set yet.")
        return self._set_dbm[uav_id]
