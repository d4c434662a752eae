"""Conversations with one vehicle: commands, parameters, clocks, missions on their way."""
