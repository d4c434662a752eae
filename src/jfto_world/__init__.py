"""Models of the physical world: terrain, radio and motion."""
