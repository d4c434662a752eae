"""Topology control: C-TOP, the baselines, and what they are made of."""
