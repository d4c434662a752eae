"""A flight as it was flown: read back from its bag, and held against the plan."""
