"""What these commands refuse, in ros2cli's words."""

from __future__ import annotations

import traceback

from jfto_msgs_py.errors import JftoError


class RosCommandError(JftoError):
    """A command that cannot do what was asked; exit status 1, as in ros2cli."""


def last_line(error: BaseException) -> str:
    """How a Python traceback of this error would end."""
    return "".join(traceback.format_exception_only(error)).rstrip()
