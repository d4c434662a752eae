"""Who is on the network: endpoints from DDS discovery, nodes from ``ros_discovery_info``."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from cyclonedds.builtin import (
    BuiltinDataReader,
    BuiltinTopicDcpsParticipant,
    BuiltinTopicDcpsPublication,
    BuiltinTopicDcpsSubscription,
)
from cyclonedds.core import InstanceState, Listener, Policy

from jfto_dds.wire import names
from jfto_dds.wire.entities import QOS_LOCK, delete_entity
from jfto_dds.wire.qos_settings import QosSettings, from_cyclone
from jfto_dds.wire.user_data import parse_user_data

_BATCH = 100


@dataclass(frozen=True)
class GraphEndpoint:
    """One reader or writer somewhere on the network."""

    gid: bytes
    dds_topic: str
    dds_type: str
    is_writer: bool
    settings: QosSettings
    type_hash: str
    user_data: dict[str, str]


@dataclass(frozen=True)
class GraphNode:
    """One node, its endpoints by gid, and the participant it lives in."""

    namespace: str
    name: str
    participant_gid: bytes
    reader_gids: tuple[bytes, ...]
    writer_gids: tuple[bytes, ...]


class Graph:
    """A picture of the network that is brought up to date whenever it is looked at.

    ``take_node_info`` returns the decoded ``ros_discovery_info`` samples that arrived since the
    last call.
    """

    def __init__(self, participant: Any, take_node_info: Callable[[], list[Any]]) -> None:
        self._take_node_info = take_node_info
        self._lock = threading.RLock()
        self._changed = threading.Condition(threading.Lock())
        self._version = 0
        self._endpoints: dict[bytes, GraphEndpoint] = {}
        self._nodes: dict[bytes, list[GraphNode]] = {}
        # Enclaves by gid.
        self._participants: dict[bytes, str] = {}
        self._listeners: list[Callable[[], None]] = []
        listener = {"on_data_available": lambda _reader: self.notify()}
        with QOS_LOCK:
            self._readers = {
                kind: BuiltinDataReader(participant, topic, listener=Listener(**listener))
                for kind, topic in (
                    ("writer", BuiltinTopicDcpsPublication),
                    ("reader", BuiltinTopicDcpsSubscription),
                    ("participant", BuiltinTopicDcpsParticipant),
                )
            }

    def close(self) -> None:
        """Stop listening; what is known stays readable."""
        with self._lock:
            readers, self._readers = self._readers, {}
            for reader in readers.values():
                delete_entity(reader)
        self.notify()

    def notify(self) -> None:
        """Tell waiters that something changed; called from DDS threads."""
        with self._changed:
            self._version += 1
            self._changed.notify_all()
        for listener in tuple(self._listeners):
            listener()

    def add_listener(self, listener: Callable[[], None]) -> None:
        """Call ``listener`` after every change, from a DDS thread: it must be quick."""
        self._listeners.append(listener)

    def remove_listener(self, listener: Callable[[], None]) -> None:
        """Stop calling ``listener``."""
        self._listeners.remove(listener)

    def wait_until(self, condition: Callable[[], bool], timeout_s: float | None) -> bool:
        """Wait for a condition that depends on the graph; False on time-out."""
        deadline = None if timeout_s is None else time.monotonic() + timeout_s
        while True:
            version = self._version
            if condition():
                return True
            with self._changed:
                while self._version == version:
                    left = None if deadline is None else deadline - time.monotonic()
                    if left is not None and left <= 0:
                        return condition()
                    self._changed.wait(left)

    def _update(self) -> None:
        # First of all, so that the participants behind these are surely known below.
        announcements = self._take_node_info()
        for kind, reader in self._readers.items():
            while True:
                with QOS_LOCK:
                    samples = reader.take(_BATCH)
                for sample in samples:
                    self._apply(kind, sample)
                if len(samples) < _BATCH:
                    break
        for info in announcements:
            gid = bytes(bytearray(info.gid.data))
            self._nodes[gid] = [
                GraphNode(
                    node.node_namespace,
                    node.node_name,
                    gid,
                    tuple(bytes(bytearray(entry.data)) for entry in node.reader_gid_seq),
                    tuple(bytes(bytearray(entry.data)) for entry in node.writer_gid_seq),
                )
                for node in info.node_entities_info_seq
            ]
        # The last words of a participant may be read after its end.
        for gid in self._nodes.keys() - self._participants.keys():
            del self._nodes[gid]

    def _apply(self, kind: str, sample: Any) -> None:
        alive = sample.sample_info.instance_state == InstanceState.Alive
        gid = sample.key.bytes
        if not alive:
            (self._participants if kind == "participant" else self._endpoints).pop(gid, None)
            return
        policy = sample.qos[Policy.Userdata]
        user_data = parse_user_data(policy.data) if policy is not None else {}
        if kind == "participant":
            self._participants[gid] = user_data.get("enclave", "")
            return
        self._endpoints[gid] = GraphEndpoint(
            gid,
            sample.topic_name,
            sample.type_name,
            kind == "writer",
            from_cyclone(sample.qos),
            user_data.get("typehash", ""),
            user_data,
        )

    def nodes(self) -> list[GraphNode]:
        """All nodes, in the order in which their participants were first seen."""
        with self._lock:
            self._update()
            return [node for nodes in self._nodes.values() for node in nodes]

    def enclave_of(self, node: GraphNode) -> str:
        """The security enclave that a node's participant names, "" where it names none."""
        with self._lock:
            return self._participants.get(node.participant_gid, "")

    def endpoints(self) -> list[GraphEndpoint]:
        """All readers and writers."""
        with self._lock:
            self._update()
            return list(self._endpoints.values())

    def topic_endpoints(self, dds_topic: str, *, writers: bool) -> list[GraphEndpoint]:
        """Readers or writers of one DDS topic."""
        return [
            endpoint
            for endpoint in self.endpoints()
            if endpoint.dds_topic == dds_topic and endpoint.is_writer == writers
        ]

    def node_of(self, gid: bytes) -> GraphNode | None:
        """Find the node that an endpoint belongs to."""
        for node in self.nodes():
            if gid in node.reader_gids or gid in node.writer_gids:
                return node
        return None

    def topics(self, endpoints: Iterator[GraphEndpoint] | None = None) -> dict[str, list[str]]:
        """Topic names and their types, sorted, of all endpoints or of those given."""
        return self._collect(endpoints, names.ros_topic, names.ros_type)

    def services(self, endpoints: Iterator[GraphEndpoint] | None = None) -> dict[str, list[str]]:
        """Service names and their types, sorted, of all endpoints or of those given."""
        return self._collect(endpoints, names.ros_service, names.ros_service_type)

    def _collect(
        self,
        endpoints: Iterator[GraphEndpoint] | None,
        name_of: Callable[[str], str | None],
        type_of: Callable[[str], str],
    ) -> dict[str, list[str]]:
        found: dict[str, set[str]] = {}
        for endpoint in self.endpoints() if endpoints is None else endpoints:
            name = name_of(endpoint.dds_topic)
            if name is not None:
                found.setdefault(name, set()).add(type_of(endpoint.dds_type))
        return {name: sorted(found[name]) for name in sorted(found)}
