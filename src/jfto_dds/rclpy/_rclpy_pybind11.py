"""Names that nodes import from rclpy's C extension: its exceptions and event records."""

from __future__ import annotations

import enum
from typing import NamedTuple


class RCLError(RuntimeError):
    """A call into the ROS client library failed."""


class RMWError(RCLError):
    """A call into the middleware failed."""


class InvalidHandle(RuntimeError):
    """An entity was used after it was destroyed."""


class UnknownROSArgsError(RCLError):
    """The command line has ROS arguments that nobody knows."""


class NodeNameNonExistentError(RCLError):
    """A query names a node that is not on the network."""


class UnsupportedEventTypeError(RCLError):
    """The middleware cannot report this kind of event."""


class ServiceIntrospectionState(enum.IntEnum):
    """What a service publishes of its calls."""

    OFF = 0
    METADATA = 1
    CONTENTS = 2


class rmw_qos_policy_kind_t(enum.IntEnum):
    """Which QoS policy an event is about."""

    RMW_QOS_POLICY_INVALID = 1 << 0
    RMW_QOS_POLICY_DURABILITY = 1 << 1
    RMW_QOS_POLICY_DEADLINE = 1 << 2
    RMW_QOS_POLICY_LIVELINESS = 1 << 3
    RMW_QOS_POLICY_RELIABILITY = 1 << 4


class rmw_requested_qos_incompatible_event_status_t(NamedTuple):
    """An endpoint with incompatible QoS was met."""

    total_count: int
    total_count_change: int
    last_policy_kind: int


class rmw_matched_status_t(NamedTuple):
    """An endpoint matched or left."""

    total_count: int
    total_count_change: int
    current_count: int
    current_count_change: int


class rmw_requested_deadline_missed_status_t(NamedTuple):
    """Data did not come in time."""

    total_count: int
    total_count_change: int


class rmw_offered_deadline_missed_status_t(NamedTuple):
    """Data was not published in time."""

    total_count: int
    total_count_change: int


class rmw_liveliness_changed_status_t(NamedTuple):
    """A publisher came to life or was lost."""

    alive_count: int
    not_alive_count: int
    alive_count_change: int
    not_alive_count_change: int


class rmw_liveliness_lost_status_t(NamedTuple):
    """A publisher failed to say that it is alive."""

    total_count: int
    total_count_change: int


class rmw_message_lost_status_t(NamedTuple):
    """Messages were lost on the way."""

    total_count: int
    total_count_change: int


class rmw_incompatible_type_status_t(NamedTuple):
    """An endpoint with another type was met; Cyclone does not report it."""

    total_count: int
    total_count_change: int


class TransitionCallbackReturnType(enum.Enum):
    """What a lifecycle callback returns."""

    SUCCESS = 97
    FAILURE = 98
    ERROR = 99

    def to_label(self) -> str:
        """The transition that this result triggers."""
        return f"transition_{self.name.lower()}"


DESTROYED_TEXT = "cannot use Destroyable because destruction was requested"
