"""Compiled kernels of the smoothing."""
