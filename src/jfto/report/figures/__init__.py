"""Figures fit for a paper: one file per figure, one style for all."""
