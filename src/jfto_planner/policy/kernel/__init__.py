"""Compiled loops of the learned planner for CPUs."""
