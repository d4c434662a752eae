"""Mission files that Mission Planner and QGroundControl open, and telemetry logs."""
