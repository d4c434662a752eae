"""Decides who is whose neighbour: C-TOP, the baselines and the metrics that compare them."""
