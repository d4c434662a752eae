"""One vehicle's flight: checks before it, start, control, progress along the route."""
