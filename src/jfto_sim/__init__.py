"""Vehicles that behave like ArduCopter 4.5.5, and the lossy links between them and a station.

`Vehicle` is a pure state machine: no sockets, no wall clock. `server` puts it on UDP and TCP.
"""

from jfto_sim.config import VehicleConfig
from jfto_sim.faults import LinkFaults
from jfto_sim.vehicle import Vehicle

__all__ = ["LinkFaults", "Vehicle", "VehicleConfig"]
