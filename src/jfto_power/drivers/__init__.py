"""What sets the transmit power of a radio, and reads it back."""

from jfto_power.drivers.applier import Applier, RadioState
from jfto_power.drivers.driver import RadioDriver, RadioError
from jfto_power.drivers.iw import IwDriver
from jfto_power.drivers.log import LogDriver
from jfto_power.drivers.sim import SimDriver

__all__ = [
    "Applier",
    "IwDriver",
    "LogDriver",
    "RadioDriver",
    "RadioError",
    "RadioState",
    "SimDriver",
]
