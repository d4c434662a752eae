"""The former home of :mod:`rclpy.event_handler`."""

from .event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks

__all__ = ["PublisherEventCallbacks", "SubscriptionEventCallbacks"]
