"""Missions, fences and rally points: what is stored, how it is transferred, how it is run."""
