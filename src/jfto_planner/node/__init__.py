"""The planner node: plans, publishes, and keeps to a lift-off over restarts."""
