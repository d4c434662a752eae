"""Nodes with a lifecycle, in the manner of REP-2002."""

from .._rclpy_pybind11 import TransitionCallbackReturnType
from .managed_entity import ManagedEntity, SimpleManagedEntity
from .node import LifecycleNode, LifecycleNodeMixin, LifecycleState
from .publisher import LifecyclePublisher

# The same names; rclpy's own list leaves these out.
TransitionCallbackReturn = TransitionCallbackReturnType
Node = LifecycleNode
Publisher = LifecyclePublisher
State = LifecycleState

__all__ = [  # noqa: RUF022 - rclpy's order
    "LifecycleNodeMixin",
    "LifecycleNode",
    "LifecycleState",
    "LifecyclePublisher",
    "ManagedEntity",
    "SimpleManagedEntity",
]
