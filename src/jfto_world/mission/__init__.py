"""Missions as steps: what is flown and done in which order, whatever protocol carries it."""
