"""Training RL-TP by REINFORCE (Algorithm 1)."""
