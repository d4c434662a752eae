"""What a plan is worth beside other algorithms, and what a flight made of it."""
