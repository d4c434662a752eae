"""What these commands refuse."""

from __future__ import annotations

from jfto_msgs_py.errors import JftoError


class RosCommandError(JftoError):
    """A command that cannot do what was asked; exit status 1, as in ros2cli."""
