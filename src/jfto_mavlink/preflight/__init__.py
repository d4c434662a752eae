"""Before anything is uploaded or armed: what a vehicle says of itself, held against its mission."""
