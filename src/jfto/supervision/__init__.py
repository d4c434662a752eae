"""Keeps the processes of a node graph running without ros2 launch."""
