"""What is wrong with a bag."""

from __future__ import annotations

from jfto_msgs_py.errors import InputError


class BagError(InputError):
    """A bag cannot be read, or not be written where it was asked for."""
