"""Creating and destroying what a node communicates with: topics and services."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from jfto_dds.wire import names
from jfto_dds.wire.entities import Reader, Writer
from jfto_dds.wire.participant import NodeEntry, Participant

from ._node_names import NodeNames
from ._node_timing import NodeTiming
from ._qos_settings import to_settings
from ._service_side import ServiceSide
from .client import Client
from .event_handler import (
    PublisherEventCallbacks,
    SubscriptionEventCallbacks,
    dds_callbacks,
)
from .publisher import Publisher
from .qos import QoSProfile, qos_profile_services_default
from .service import Service
from .subscription import Subscription
from .type_support import check_is_valid_msg_type, check_is_valid_srv_type

_Side = TypeVar("_Side", bound=ServiceSide)


class NodeEndpoints(NodeNames, NodeTiming):
    """Communication part of :class:`rclpy.node.Node`."""

    _participant: Participant
    _entry: NodeEntry
    _context: Any
    _default_callback_group: Any
    _logger: Any
    _wake_executor: Callable[[], None]

    def _init_endpoints(self) -> None:
        self._publishers: list[Publisher] = []
        self._subscriptions: list[Subscription] = []
        self._clients: list[Client] = []
        self._services: list[Service] = []
        self._timers = []
        self._guards = []
        self._waitables: list[Any] = []

    def create_publisher(
        self,
        msg_type: Any,
        topic: str,
        qos_profile: QoSProfile | int,
        *,
        callback_group: Any = None,
        event_callbacks: PublisherEventCallbacks | None = None,
        qos_overriding_options: Any = None,
        publisher_class: type[Publisher] = Publisher,
    ) -> Any:
        """Create a publisher; an integer QoS is a history depth."""
        profile = _profile(qos_profile)
        _refuse_overrides(qos_overriding_options)
        check_is_valid_msg_type(msg_type)
        self._check_alive("publisher")
        topic_name = self._resolve(topic)
        group = callback_group or self._default_callback_group
        handlers = (event_callbacks or PublisherEventCallbacks()).create_event_handlers(
            group, topic, self._logger, self._wake_executor
        )
        dds_topic = names.topic_name(topic_name)
        peers = self._participant.graph.topic_endpoints(dds_topic, writers=False)
        settings = to_settings(profile, [peer.settings for peer in peers], writer=True)
        writer = self._participant.create_writer(
            self._entry,
            dds_topic,
            msg_type._TYPE_SUPPORT.full_name,
            settings,
            callbacks=dds_callbacks(handlers),
        )
        publisher = publisher_class(
            self, msg_type, topic, topic_name, profile, writer, list(handlers.values())
        )
        self._publishers.append(publisher)
        self._waitables.extend(handlers.values())
        self._wake_executor()
        return publisher

    def create_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: Callable[..., Any],
        qos_profile: QoSProfile | int,
        *,
        callback_group: Any = None,
        event_callbacks: SubscriptionEventCallbacks | None = None,
        qos_overriding_options: Any = None,
        raw: bool = False,
    ) -> Subscription:
        """Create a subscription; ``raw`` hands the callback bytes."""
        profile = _profile(qos_profile)
        _refuse_overrides(qos_overriding_options)
        check_is_valid_msg_type(msg_type)
        self._check_alive("subscription")
        topic_name = self._resolve(topic)
        group = callback_group or self._default_callback_group
        handlers = (event_callbacks or SubscriptionEventCallbacks()).create_event_handlers(
            group, topic, self._logger, self._wake_executor
        )
        subscription = Subscription(
            self, msg_type, topic, topic_name, callback, group, profile, raw
        )
        subscription.event_handlers = list(handlers.values())
        dds_topic = names.topic_name(topic_name)
        peers = self._participant.graph.topic_endpoints(dds_topic, writers=True)
        settings = to_settings(profile, [peer.settings for peer in peers], writer=False)
        subscription._reader = self._participant.create_reader(
            self._entry,
            dds_topic,
            msg_type._TYPE_SUPPORT.full_name,
            settings,
            subscription._on_data,
            callbacks=dds_callbacks(handlers),
        )
        group.add_entity(subscription)
        self._subscriptions.append(subscription)
        self._waitables.extend(handlers.values())
        self._wake_executor()
        return subscription

    def create_service(
        self,
        srv_type: Any,
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: Any = None,
    ) -> Service:
        """Create a service server."""

        def make(service_name: str, group: Any) -> Service:
            return Service(self, srv_type, srv_name, service_name, callback, group, qos_profile)

        return self._open_side(srv_type, srv_name, callback_group, make, self._services)

    def create_client(
        self,
        srv_type: Any,
        srv_name: str,
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: Any = None,
    ) -> Client:
        """Create a service client."""

        def make(service_name: str, group: Any) -> Client:
            return Client(self, srv_type, srv_name, service_name, group, qos_profile)

        return self._open_side(srv_type, srv_name, callback_group, make, self._clients)

    def _open_side(
        self,
        srv_type: Any,
        srv_name: str,
        callback_group: Any,
        make: Callable[[str, Any], _Side],
        owned: list[_Side],
    ) -> _Side:
        """Make a server or a client, with its reader and writer, which share an id."""
        check_is_valid_srv_type(srv_type)
        serves = owned is self._services
        self._check_alive("service" if serves else "client")
        service_name = self._resolve(srv_name, is_service=True)
        group = callback_group or self._default_callback_group
        side = make(service_name, group)
        request = (names.request_name(service_name), side._request.full_name)
        reply = (names.reply_name(service_name), side._response.full_name)
        hears, says = (request, reply) if serves else (reply, request)
        settings = to_settings(side.qos_profile, [], writer=True)
        identity = {side._ROLE: self._participant.new_identity()}

        def open_reader() -> Reader:
            callbacks = {} if serves else {"on_subscription_matched": side._on_matched}
            return self._participant.create_reader(
                self._entry, *hears, settings, side._on_data,
                service=True, identity=identity, callbacks=callbacks,
            )  # fmt: skip

        def open_writer() -> Writer:
            return self._participant.create_writer(
                self._entry, *says, settings,
                service=True, identity=identity,
                callbacks={"on_publication_matched": side._on_matched},
            )  # fmt: skip

        # What replies go through comes first: a request must find it.
        if serves:
            writer, reader = open_writer(), open_reader()
        else:
            reader, writer = open_reader(), open_writer()
        side._attach(reader, writer)
        group.add_entity(side)
        owned.append(side)
        self._wake_executor()
        return side

    def add_waitable(self, waitable: Any) -> None:
        """Wait for something of the program's own, which is not supported."""
        msg = f"jfto_dds does not support add_waitable ({waitable!r})"
        raise NotImplementedError(msg)

    def remove_waitable(self, waitable: Any) -> None:
        """Stop waiting for something; only what add_waitable took could be meant."""
        msg = f"jfto_dds does not support remove_waitable ({waitable!r})"
        raise NotImplementedError(msg)

    def _remove_endpoint(self, endpoint: Any) -> None:
        self._participant.remove_endpoint(self._entry, endpoint)

    def _destroy_from(self, owned: list[Any], entity: Any) -> bool:
        if entity not in owned:
            return False
        owned.remove(entity)
        for handler in getattr(entity, "event_handlers", ()):
            if handler in self._waitables:
                self._waitables.remove(handler)
        entity.destroy()
        self._wake_executor()
        return True

    def destroy_publisher(self, publisher: Publisher) -> bool:
        """Destroy a publisher; False where it is none of this node's."""
        return self._destroy_from(self._publishers, publisher)

    def destroy_subscription(self, subscription: Subscription) -> bool:
        """Destroy a subscription; False where it is none of this node's."""
        return self._destroy_from(self._subscriptions, subscription)

    def destroy_client(self, client: Client) -> bool:
        """Destroy a client; False where it is none of this node's."""
        return self._destroy_from(self._clients, client)

    def destroy_service(self, service: Service) -> bool:
        """Destroy a service; False where it is none of this node's."""
        return self._destroy_from(self._services, service)

    def _destroy_endpoints(self) -> None:
        owned: list[list[Any]] = [
            self._publishers,
            self._subscriptions,
            self._clients,
            self._services,
            self._timers,
            self._guards,
        ]
        for entities in owned:
            for entity in tuple(entities):
                self._destroy_from(entities, entity)


def _profile(given: Any) -> QoSProfile:
    if isinstance(given, QoSProfile):
        return given
    if not isinstance(given, int):
        msg = f"Expected QoSProfile or int, but received {type(given)!r}"
        raise TypeError(msg)
    if given < 0:
        msg = "history depth must be greater than or equal to zero"
        raise ValueError(msg)
    return QoSProfile(depth=given)


def _refuse_overrides(options: Any) -> None:
    if options is not None:
        msg = "jfto_dds does not support qos_overriding_options: set the QoS in the code"
        raise NotImplementedError(msg)
