"""What every radio driver does."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import Protocol

from jfto_msgs_py.errors import InputError, JftoError


class RadioError(JftoError):
    """A radio could not be set or read; the message says why and what to do."""


class RadioDriver(Protocol):
    """Sets the transmit power of the radios of some UAVs and reads it back."""

    def apply(self, uav_id: str, dbm: float) -> float:
        """Set a power in dBm, -inf for silence; returns what the radio says it is set to.

        A radio that cannot do what is asked does what is nearest. Raises InputError for a UAV that
        the driver does not serve or a power that is no number, RadioError where the radio fails.
        """

    def read(self, uav_id: str) -> float:
        """What a radio is set to, dBm. Raises InputError, RadioError as `apply` does."""


def check_power(uav_id: str, dbm: float, served: Collection[str]) -> None:
    """Raise InputError unless the UAV is served and the power is a number or -inf."""
    check_served(uav_id, served)
    if math.isnan(dbm) or dbm == math.inf:
        raise InputError(f"power of {uav_id} is {dbm} dBm, must be a number or -inf.")


def check_served(uav_id: str, served: Collection[str]) -> None:
    """Raise InputError unless the UAV is served."""
    if uav_id not in served:
        raise InputError(f"This driver sets the radios of {', '.join(served)}, not of {uav_id}.")
