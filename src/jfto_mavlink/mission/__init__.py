"""Missions: items, what the autopilot keeps of them, building from a plan, transfer protocols."""
