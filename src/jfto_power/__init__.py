"""Decides how loudly each UAV transmits."""
