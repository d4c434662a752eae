"""GUIDED flight: a trajectory streamed to a vehicle as moving targets, and stopped on purpose."""
