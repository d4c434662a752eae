"""rclpy's handle on its C extension."""

from .. import _rclpy_pybind11 as rclpy_implementation

__all__ = ["rclpy_implementation"]
