"""Looking at a ROS 2 graph from the command line, with the habits of ros2cli, by plain rclpy calls.

Modules import rclpy: `require_ros()` comes first.
"""

from jfto_msgs_py.errors import JftoError


class RosCommandError(JftoError):
    """A command that cannot do what was asked; exit status 1, as in ros2cli."""
