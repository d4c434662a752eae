"""Events of publishers and subscriptions: incompatible QoS, matches, deadlines, liveliness."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any

from jfto_dds.wire.qos_settings import POLICY_NAMES

from ._rclpy_pybind11 import (
    UnsupportedEventTypeError,
    rmw_incompatible_type_status_t,
    rmw_liveliness_changed_status_t,
    rmw_liveliness_lost_status_t,
    rmw_matched_status_t,
    rmw_message_lost_status_t,
    rmw_offered_deadline_missed_status_t,
    rmw_qos_policy_kind_t,
    rmw_requested_deadline_missed_status_t,
    rmw_requested_qos_incompatible_event_status_t,
)
from .qos import qos_policy_name_from_kind
from .waitable import Waitable

__all__ = [
    "EventHandler",
    "PublisherEventCallbacks",
    "SubscriptionEventCallbacks",
    "UnsupportedEventTypeError",
]

QoSRequestedDeadlineMissedInfo = rmw_requested_deadline_missed_status_t
QoSLivelinessChangedInfo = rmw_liveliness_changed_status_t
QoSMessageLostInfo = rmw_message_lost_status_t
QoSRequestedIncompatibleQoSInfo = rmw_requested_qos_incompatible_event_status_t
QoSSubscriptionMatchedInfo = rmw_matched_status_t
QoSOfferedDeadlineMissedInfo = rmw_offered_deadline_missed_status_t
QoSLivelinessLostInfo = rmw_liveliness_lost_status_t
QoSPublisherMatchedInfo = rmw_matched_status_t
QoSOfferedIncompatibleQoSInfo = rmw_requested_qos_incompatible_event_status_t
IncompatibleTypeInfo = rmw_incompatible_type_status_t


def _counts(record: type) -> Callable[[Any], Any]:
    return lambda status: record(status.total_count, status.total_count_change)


def _matched(status: Any) -> Any:
    return rmw_matched_status_t(
        status.total_count,
        status.total_count_change,
        status.current_count,
        status.current_count_change,
    )


def _liveliness(status: Any) -> Any:
    return rmw_liveliness_changed_status_t(
        status.alive_count,
        status.not_alive_count,
        status.alive_count_change,
        status.not_alive_count_change,
    )


def _incompatible(status: Any) -> Any:
    name = POLICY_NAMES.get(status.last_policy_id)
    if name is None:
        # Not QoS but another type on this topic, which rclpy does not report.
        return None
    kind = rmw_qos_policy_kind_t[f"RMW_QOS_POLICY_{name}"]
    return rmw_requested_qos_incompatible_event_status_t(
        status.total_count, status.total_count_change, kind
    )


# Callback argument -> (DDS listener, conversion of its status)
_PUBLISHER_EVENTS: dict[str, tuple[str, Callable[[Any], Any]]] = {
    "deadline": ("on_offered_deadline_missed", _counts(rmw_offered_deadline_missed_status_t)),
    "incompatible_qos": ("on_offered_incompatible_qos", _incompatible),
    "liveliness": ("on_liveliness_lost", _counts(rmw_liveliness_lost_status_t)),
    "matched": ("on_publication_matched", _matched),
}
_SUBSCRIPTION_EVENTS: dict[str, tuple[str, Callable[[Any], Any]]] = {
    "deadline": ("on_requested_deadline_missed", _counts(rmw_requested_deadline_missed_status_t)),
    "incompatible_qos": ("on_requested_incompatible_qos", _incompatible),
    "liveliness": ("on_liveliness_changed", _liveliness),
    "message_lost": ("on_sample_lost", _counts(rmw_message_lost_status_t)),
    "matched": ("on_subscription_matched", _matched),
}


class EventHandler(Waitable):
    """Runs a callback in the executor for each event that DDS reports."""

    def __init__(
        self,
        *,
        callback_group: Any,
        callback: Callable[[Any], Any],
        convert: Callable[[Any], Any],
        wake: Callable[[], None],
    ) -> None:
        super().__init__(callback_group)
        self.callback = callback
        self._convert = convert
        self._wake = wake
        self._pending: deque[Any] = deque()
        self._destroyed = False

    def _notify(self, _entity: Any, status: Any) -> None:
        # Called in a DDS thread, which owns the status only until we return.
        event = self._convert(status)
        if event is not None:
            self._pending.append(event)
            self._wake()

    def _is_ready(self) -> bool:
        return bool(self._pending) and not self._destroyed

    def _take(self) -> Callable[[], Any] | None:
        if not self._pending:
            return None
        event = self._pending.popleft()
        return lambda: self.callback(event)

    def destroy(self) -> None:
        """Never call back again."""
        self._destroyed = True


class _EventCallbacks:
    """What publisher and subscription callbacks have in common."""

    _EVENTS: dict[str, tuple[str, Callable[[Any], Any]]]
    incompatible_type: Any
    use_default_callbacks: bool

    def __init__(self, use_default_callbacks: bool, **callbacks: Any) -> None:
        for name, callback in callbacks.items():
            setattr(self, name, callback)
        self.use_default_callbacks = use_default_callbacks

    def _default_incompatible_qos(self, topic_name: str, logger: Any) -> Callable[[Any], None]:
        raise NotImplementedError

    def create_event_handlers(
        self, callback_group: Any, topic_name: str, logger: Any, wake: Callable[[], None]
    ) -> dict[str, EventHandler]:
        """Build the handlers that are asked for, by the DDS listener that feeds them."""
        handlers = {}
        for name, (listener, convert) in self._EVENTS.items():
            callback = getattr(self, name)
            if callback is None and name == "incompatible_qos" and self.use_default_callbacks:
                callback = self._default_incompatible_qos(topic_name, logger)
            if callback is not None:
                handlers[listener] = EventHandler(
                    callback_group=callback_group, callback=callback, convert=convert, wake=wake
                )
        if self.incompatible_type is not None or self.use_default_callbacks:
            # Cyclone never reports this event, but rclpy has a handler for it.
            handlers["incompatible_type"] = EventHandler(
                callback_group=callback_group,
                callback=self.incompatible_type or (lambda _event: None),
                convert=_counts(rmw_incompatible_type_status_t),
                wake=wake,
            )
        return handlers


def dds_callbacks(handlers: dict[str, EventHandler]) -> dict[str, Callable[..., None]]:
    """The DDS listeners that feed handlers."""
    return {name: handler._notify for name, handler in handlers.items() if name.startswith("on_")}


class SubscriptionEventCallbacks(_EventCallbacks):
    """Callbacks for the events of a subscription; ``incompatible_type`` never comes."""

    _EVENTS = _SUBSCRIPTION_EVENTS

    def __init__(
        self,
        *,
        deadline: Callable[[Any], Any] | None = None,
        incompatible_qos: Callable[[Any], Any] | None = None,
        liveliness: Callable[[Any], Any] | None = None,
        message_lost: Callable[[Any], Any] | None = None,
        incompatible_type: Callable[[Any], Any] | None = None,
        matched: Callable[[Any], Any] | None = None,
        use_default_callbacks: bool = True,
    ) -> None:
        super().__init__(
            use_default_callbacks,
            deadline=deadline,
            incompatible_qos=incompatible_qos,
            liveliness=liveliness,
            message_lost=message_lost,
            incompatible_type=incompatible_type,
            matched=matched,
        )

    def _default_incompatible_qos(self, topic_name: str, logger: Any) -> Callable[[Any], None]:
        def warn(event: Any) -> None:
            policy = qos_policy_name_from_kind(event.last_policy_kind)
            logger.warning(
                f"New publisher discovered on topic '{topic_name}', offering incompatible QoS. "
                f"No messages will be received from it. Last incompatible policy: {policy}"
            )

        return warn


class PublisherEventCallbacks(_EventCallbacks):
    """Callbacks for the events of a publisher; ``incompatible_type`` never comes."""

    _EVENTS = _PUBLISHER_EVENTS

    def __init__(
        self,
        *,
        deadline: Callable[[Any], Any] | None = None,
        liveliness: Callable[[Any], Any] | None = None,
        incompatible_qos: Callable[[Any], Any] | None = None,
        incompatible_type: Callable[[Any], Any] | None = None,
        matched: Callable[[Any], Any] | None = None,
        use_default_callbacks: bool = True,
    ) -> None:
        super().__init__(
            use_default_callbacks,
            deadline=deadline,
            liveliness=liveliness,
            incompatible_qos=incompatible_qos,
            incompatible_type=incompatible_type,
            matched=matched,
        )

    def _default_incompatible_qos(self, topic_name: str, logger: Any) -> Callable[[Any], None]:
        def warn(event: Any) -> None:
            policy = qos_policy_name_from_kind(event.last_policy_kind)
            logger.warning(
                f"New subscription discovered on topic '{topic_name}', requesting incompatible "
                f"QoS. No messages will be sent to it. Last incompatible policy: {policy}"
            )

        return warn
