"""What the air between the radios is like at one moment."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.errors import MessageError
from jfto_msgs_py.types import Array


@dataclass(frozen=True, eq=False)
class AirReport:
    """Radios and links of a fleet at `stamp_ns` (ns since the epoch); arrays follow `uav_ids`.

    `power_w` (A,) is sent, `energy_j` (A,) used so far; `rate_bps` (A, A) flows from row to column
    over links, 0 where there is none; `delivery` (A, A) is the share of packets from row that
    column receives; `gain` (A, A) the path gain that a receiver measures, 0 where it hears nothing.
    Raises MessageError for arrays of another shape or with values that cannot be.
    """

    stamp_ns: int
    uav_ids: tuple[str, ...]
    power_w: Array
    energy_j: Array
    rate_bps: Array
    delivery: Array
    gain: Array

    def __post_init__(self) -> None:
        fleet = len(self.uav_ids)
        for name in ("power_w", "energy_j", "rate_bps", "delivery", "gain"):
            array = getattr(self, name)
            rank = 1 if name in ("power_w", "energy_j") else 2
            if array.shape != (fleet,) * rank:
                raise MessageError(name, f"shape is {array.shape}, expected {(fleet,) * rank}")
            if not (np.isfinite(array).all() and (array >= 0).all()):
                raise MessageError(name, "holds values that are negative or not finite")

    @property
    def links(self) -> NDArray[np.bool_]:
        """Who is linked with whom, (A, A)."""
        return self.rate_bps > 0

    @property
    def throughput_bps(self) -> float:
        """Network throughput: every linked pair counts with the mean of its two directions."""
        return float(self.rate_bps.sum() / 2)


class AirArray(NamedTuple):
    """One array of a report: `values` (A,) or (A, A) over `uav_ids`, measured at `stamp_ns`."""

    stamp_ns: int
    uav_ids: tuple[str, ...]
    values: Array
