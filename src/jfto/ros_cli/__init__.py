"""Looking at a ROS 2 graph from the command line: what `jfto topic`, `node`, `service`, `param` do.

Output is laid out as ros2cli prints it. Only plain rclpy calls are used.
"""
