"""The air between simulated radios: who hears whom, how well, and what it costs."""

from jfto_sim.air.air import Air, AirMember
from jfto_sim.air.channel import AirSettings, Ground
from jfto_sim.air.fleet_air import FleetAir

__all__ = ["Air", "AirMember", "AirSettings", "FleetAir", "Ground"]
