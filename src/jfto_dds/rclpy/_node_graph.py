"""What a node can find out about the network."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from jfto_dds.wire import names
from jfto_dds.wire.graph import GraphEndpoint, GraphNode
from jfto_dds.wire.participant import Participant

from ._names import namespace_problem
from ._qos_settings import from_settings
from ._rclpy_pybind11 import DESTROYED_TEXT, NodeNameNonExistentError, RCLError
from .exceptions import InvalidHandle
from .expand_topic_name import expand_topic_name
from .topic_endpoint_info import TopicEndpointInfo, TopicEndpointTypeEnum
from .type_hash import TypeHash

_NamesAndTypes = list[tuple[str, list[str]]]


class NodeGraph:
    """Graph part of :class:`rclpy.node.Node`."""

    _participant: Participant
    _context: Any
    _destroyed: bool
    get_name: Callable[[], str]
    get_namespace: Callable[[], str]

    def _graph(self, what: str) -> Any:
        if self._destroyed:
            raise InvalidHandle(DESTROYED_TEXT)
        if not self._context.ok():
            msg = f"failed to get {what}: rcl node's context is invalid"
            raise RCLError(msg)
        return self._participant.graph

    def get_topic_names_and_types(self, no_demangle: bool = False) -> _NamesAndTypes:
        """All topics and their types; ``no_demangle`` shows DDS names."""
        graph = self._graph("topic names and types")
        if not no_demangle:
            return list(graph.topics().items())
        found: dict[str, set[str]] = {}
        for endpoint in graph.endpoints():
            found.setdefault(endpoint.dds_topic, set()).add(endpoint.dds_type)
        return [(name, sorted(found[name])) for name in sorted(found)]

    def get_service_names_and_types(self) -> _NamesAndTypes:
        """All services and their types."""
        return list(self._graph("service names and types").services().items())

    def get_node_names(self) -> list[str]:
        """Names of all nodes, without namespaces."""
        return [node.name for node in self._graph("node names").nodes()]

    def get_fully_qualified_node_names(self) -> list[str]:
        """Full names of all nodes."""
        return [_full_name(node) for node in self._graph("node names").nodes()]

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        """Names and namespaces of all nodes."""
        return [(node.name, node.namespace) for node in self._graph("node names").nodes()]

    def get_node_names_and_namespaces_with_enclaves(self) -> list[tuple[str, str, str]]:
        """Names, namespaces and security enclaves of all nodes."""
        graph = self._graph("node names")
        return [(node.name, node.namespace, graph.enclave_of(node)) for node in graph.nodes()]

    def _node_endpoints(
        self, what: str, name: str, namespace: str, *, writers: bool
    ) -> list[GraphEndpoint]:
        graph = self._graph(what)
        problem = namespace_problem(namespace)
        if problem is not None:
            msg = f"failed to get {what}: {problem.text}, result: 2"
            raise RCLError(msg)
        nodes = [
            node for node in graph.nodes() if node.name == name and node.namespace == namespace
        ]
        if not nodes:
            msg = f"cannot get {what} for nonexistent node: error not set"
            raise NodeNameNonExistentError(msg)
        gids = {
            gid for node in nodes for gid in (node.writer_gids if writers else node.reader_gids)
        }
        return [endpoint for endpoint in graph.endpoints() if endpoint.gid in gids]

    def get_publisher_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> _NamesAndTypes:
        """Topics that a node publishes."""
        _no_demangle(no_demangle)
        what = "publisher names and types"
        found = self._node_endpoints(what, node_name, node_namespace, writers=True)
        return list(self._participant.graph.topics(iter(found)).items())

    def get_subscriber_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> _NamesAndTypes:
        """Topics that a node subscribes to."""
        _no_demangle(no_demangle)
        what = "subscriber names and types"
        found = self._node_endpoints(what, node_name, node_namespace, writers=False)
        return list(self._participant.graph.topics(iter(found)).items())

    def get_service_names_and_types_by_node(
        self, node_name: str, node_namespace: str
    ) -> _NamesAndTypes:
        """Services that a node offers."""
        return self._services_by_node(node_name, node_namespace, names.REQUEST)

    def get_client_names_and_types_by_node(
        self, node_name: str, node_namespace: str
    ) -> _NamesAndTypes:
        """Services that a node calls."""
        return self._services_by_node(node_name, node_namespace, names.REPLY)

    def _services_by_node(self, name: str, namespace: str, reads: str) -> _NamesAndTypes:
        what = "service names and types"
        found = self._node_endpoints(what, name, namespace, writers=False)
        chosen = (endpoint for endpoint in found if endpoint.dds_topic.startswith(reads + "/"))
        return list(self._participant.graph.services(chosen).items())

    def _count(self, dds_topic: str, *, writers: bool) -> int:
        return len(self._graph("counts").topic_endpoints(dds_topic, writers=writers))

    def _expand(self, name: str) -> str:
        if self._destroyed:
            raise InvalidHandle(DESTROYED_TEXT)
        return expand_topic_name(name, self.get_name(), self.get_namespace())

    def count_publishers(self, topic_name: str) -> int:
        """Count the publishers of a topic; relative names get this node's namespace."""
        return self._count(names.topic_name(self._expand(topic_name)), writers=True)

    def count_subscribers(self, topic_name: str) -> int:
        """Count the subscriptions of a topic."""
        return self._count(names.topic_name(self._expand(topic_name)), writers=False)

    def count_clients(self, service_name: str) -> int:
        """Count the clients of a service."""
        return self._count(names.request_name(self._expand(service_name)), writers=True)

    def count_services(self, service_name: str) -> int:
        """Count the servers of a service."""
        return self._count(names.request_name(self._expand(service_name)), writers=False)

    def get_publishers_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """Describe the publishers of a topic."""
        return self._info_by_topic(topic_name, no_mangle, writers=True)

    def get_subscriptions_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """Describe the subscriptions of a topic."""
        return self._info_by_topic(topic_name, no_mangle, writers=False)

    def _info_by_topic(
        self, topic_name: str, no_mangle: bool, *, writers: bool
    ) -> list[TopicEndpointInfo]:
        graph = self._graph("endpoint information")
        dds_topic = topic_name if no_mangle else names.topic_name(self._expand(topic_name))
        kind = TopicEndpointTypeEnum.PUBLISHER if writers else TopicEndpointTypeEnum.SUBSCRIPTION
        found = []
        for endpoint in graph.topic_endpoints(dds_topic, writers=writers):
            node = graph.node_of(endpoint.gid)
            found.append(
                TopicEndpointInfo(
                    node_name=node.name if node else "_NODE_NAME_UNKNOWN_",
                    node_namespace=node.namespace if node else "_NODE_NAMESPACE_UNKNOWN_",
                    topic_type=names.ros_type(endpoint.dds_type),
                    topic_type_hash=TypeHash._from_text(endpoint.type_hash),
                    endpoint_type=kind,
                    endpoint_gid=list(endpoint.gid),
                    qos_profile=from_settings(endpoint.settings),
                )
            )
        return found

    def wait_for_node(self, fully_qualified_node_name: str, timeout: float) -> bool:
        """Wait for a node to appear; False on time-out."""
        wanted = "/" + fully_qualified_node_name.lstrip("/")
        graph = self._graph("node names")

        def settled() -> bool:
            return not self._context.ok() or any(
                _full_name(node) == wanted for node in graph.nodes()
            )

        return graph.wait_until(settled, timeout) and self._context.ok()


def _no_demangle(requested: bool) -> None:
    if requested:
        msg = "jfto_dds does not support no_demangle for the topics of a single node"
        raise NotImplementedError(msg)


def _full_name(node: GraphNode) -> str:
    root = "" if node.namespace == "/" else node.namespace
    return f"{root}/{node.name}"
