"""Modules that rclpy keeps for itself but that nodes import now and then."""
