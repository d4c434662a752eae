"""All that a terminal shows of a run: lines, bars and results."""
