"""The air between simulated radios: who hears whom, how well, and what it costs."""

from jfto_sim.air.air import Air, AirMember
from jfto_sim.air.fleet_air import FleetAir
from jfto_sim.air.settings import AirSettings
from jfto_sim.air.slow_error import SlowError

__all__ = ["Air", "AirMember", "AirSettings", "FleetAir", "SlowError"]
