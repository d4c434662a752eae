"""ROS 2 bags: recording that survives a kill, reading, playing, and replay without a clock."""
