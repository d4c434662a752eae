"""Keeps the processes of a node graph running on a machine without ROS 2."""
