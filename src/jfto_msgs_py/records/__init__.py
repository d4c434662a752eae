"""Records that cross borders between rooms, with nothing of ROS in them."""
