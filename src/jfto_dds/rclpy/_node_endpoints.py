"""Creating and destroying what a node communicates with: topics and services."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from jfto_dds.wire import names
from jfto_dds.wire.participant import NodeEntry, Participant

from ._node_names import NodeNames
from ._node_timing import NodeTiming
from ._qos_settings import to_settings
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
        check_is_valid_srv_type(srv_type)
        self._check_alive("service")
        service_name = self._resolve(srv_name, is_service=True)
        group = callback_group or self._default_callback_group
        service = Service(self, srv_type, srv_name, service_name, callback, group, qos_profile)
        settings = to_settings(qos_profile, [], writer=True)
        identity = {"serviceid": self._participant.new_identity()}
        # The reply writer first: a request must find it.
        service._writer = self._participant.create_writer(
            self._entry,
            names.reply_name(service_name),
            service._response.full_name,
            settings,
            service=True,
            identity=identity,
            callbacks={"on_publication_matched": service._on_matched},
        )
        service._reader = self._participant.create_reader(
            self._entry,
            names.request_name(service_name),
            service._request.full_name,
            settings,
            service._on_data,
            service=True,
            identity=identity,
        )
        group.add_entity(service)
        self._services.append(service)
        self._wake_executor()
        return service

    def create_client(
        self,
        srv_type: Any,
        srv_name: str,
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: Any = None,
    ) -> Client:
        """Create a service client."""
        check_is_valid_srv_type(srv_type)
        self._check_alive("client")
        service_name = self._resolve(srv_name, is_service=True)
        group = callback_group or self._default_callback_group
        client = Client(self, srv_type, srv_name, service_name, group, qos_profile)
        settings = to_settings(qos_profile, [], writer=True)
        identity = {"clientid": self._participant.new_identity()}

        def matched(_entity: Any, _status: Any) -> None:
            self._participant.graph.notify()

        reader = self._participant.create_reader(
            self._entry,
            names.reply_name(service_name),
            client._response.full_name,
            settings,
            client._on_data,
            service=True,
            identity=identity,
            callbacks={"on_subscription_matched": matched},
        )
        writer = self._participant.create_writer(
            self._entry,
            names.request_name(service_name),
            client._request.full_name,
            settings,
            service=True,
            identity=identity,
            callbacks={"on_publication_matched": matched},
        )
        client._attach(reader, writer)
        group.add_entity(client)
        self._clients.append(client)
        self._wake_executor()
        return client

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
