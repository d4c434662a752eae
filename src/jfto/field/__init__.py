"""What the operator sees while the fleet flies: one screen, fed from a frozen state."""
