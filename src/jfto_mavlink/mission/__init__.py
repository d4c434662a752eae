"""Missions: building them from a plan, limits, what the autopilot keeps, delivery."""
