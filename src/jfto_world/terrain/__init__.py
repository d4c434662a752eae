"""Elevation models and geodesy."""
