"""What the operator sees while the fleet flies: one screen, drawn from a frozen state."""
