"""Decides where each UAV flies: coverage, starting points, routes and their certificate."""
