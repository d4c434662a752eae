"""Simulated vehicles on the pads of a plan: what they are, the air between them, their time."""
