"""RL-TP: the learned trajectory planner (section "Trajectory Design", Algorithm 1)."""
