"""Where the vehicle is asked to be, and how it gets there: target generators and the body."""
