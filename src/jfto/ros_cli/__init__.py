"""Looking at a ROS 2 graph from the command line, with the habits of ros2cli, by plain rclpy calls.

Modules import rclpy: `require_ros()` comes first.
"""
