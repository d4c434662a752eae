"""One DDS participant per context: its domain, its endpoints, and what it says of its nodes."""

from __future__ import annotations

import atexit
import itertools
import threading
from collections.abc import Callable
from typing import Any

import numpy as np
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant

from jfto_dds.messages.decoder import MalformedPayloadError
from jfto_dds.messages.message_class import message_class
from jfto_dds.wire import network, user_data
from jfto_dds.wire.entities import QOS_LOCK, Reader, Writer, delete_entity
from jfto_dds.wire.graph import Graph
from jfto_dds.wire.idl_types import topic_type
from jfto_dds.wire.qos_settings import QosSettings

_DISCOVERY_TOPIC = "ros_discovery_info"
_DISCOVERY_TYPE = "rmw_dds_common/msg/ParticipantEntitiesInfo"

_domains: dict[int, tuple[Any, int]] = {}
_domains_lock = threading.Lock()
# Keeps participants alive until they are closed: collected by chance, their listeners could be
# freed while DDS still calls them.
_open: set[Participant] = set()


def _open_domain(domain_id: int) -> None:
    """Configure a domain for its first participant; a process can do that once per domain."""
    with _domains_lock:
        domain, users = _domains.get(domain_id, (None, 0))
        configuration = network.configuration()
        if users == 0 and configuration is not None:
            domain = Domain(domain_id, configuration)
        _domains[domain_id] = (domain, users + 1)


def _close_domain(domain_id: int) -> None:
    with _domains_lock:
        domain, users = _domains.pop(domain_id)
        if users > 1:
            _domains[domain_id] = (domain, users - 1)
        elif domain is not None:
            delete_entity(domain)


class NodeEntry:
    """A node of this participant, with the gids of its endpoints, as others shall see it."""

    def __init__(self, namespace: str, name: str) -> None:
        self.namespace = namespace
        self.name = name
        self.reader_gids: list[bytes] = []
        self.writer_gids: list[bytes] = []


class Participant:
    """Creates endpoints and announces which node they belong to."""

    def __init__(self, domain_id: int, enclave: str = "/") -> None:
        self.domain_id = domain_id
        self._lock = threading.RLock()
        self._endpoints: list[Reader | Writer] = []
        self._nodes: list[NodeEntry] = []
        self._closed = False
        self._identities = itertools.count(1)
        self._info_lock = threading.Lock()
        # The latest announcement of each participant that nobody has looked at yet.
        self._unread_info: dict[int, bytes] = {}
        self._discovery: Reader | None = None
        _open_domain(domain_id)
        with QOS_LOCK:
            said = Policy.Userdata(user_data.participant_user_data(enclave))
            self._entity = DomainParticipant(domain_id, Qos(said))
        self.gid: bytes = self._entity.guid.bytes
        self._info = message_class(_DISCOVERY_TYPE)
        support = self._info._TYPE_SUPPORT
        announced = user_data.endpoint_user_data(support.hash)
        kind = topic_type(_DISCOVERY_TYPE)
        self._announcer = Writer(
            self._entity,
            _DISCOVERY_TOPIC,
            kind,
            QosSettings(depth=1, transient_local=True),
            announced,
        )
        discovery = Reader(
            self._entity,
            _DISCOVERY_TOPIC,
            kind,
            QosSettings(keep_all=True, transient_local=True),
            announced,
            self._on_discovery,
        )
        self.graph = Graph(self._entity, self._take_node_info)
        self._discovery = discovery
        _open.add(self)

    @property
    def is_closed(self) -> bool:
        """Whether all entities are gone."""
        return self._closed

    def new_identity(self) -> str:
        """Make an id for a service or client that no other has."""
        return user_data.service_identity(self.gid, next(self._identities))

    def _on_discovery(self) -> None:
        # Called in a DDS thread. Taken at once: the reader keeps all, and a node that never
        # looks at the graph would collect announcements for ever.
        if self._discovery is not None:
            self._collect_info(self._discovery)
            self.graph.notify()

    def _collect_info(self, discovery: Reader) -> None:
        with self._info_lock:
            while taken := discovery.take(100):
                self._unread_info.update(
                    (sample.publication_handle, sample.payload) for sample in taken
                )

    def _take_node_info(self) -> list[Any]:
        if self._discovery is not None:
            self._collect_info(self._discovery)
        with self._info_lock:
            unread, self._unread_info = self._unread_info, {}
        decoded = []
        for payload in unread.values():
            try:
                decoded.append(self._info._TYPE_SUPPORT.deserialize(payload))
            except MalformedPayloadError:
                # A foreign participant's broken announcement: its nodes stay unknown.
                continue
        return decoded

    def add_node(self, namespace: str, name: str) -> NodeEntry:
        """Announce a node."""
        entry = NodeEntry(namespace, name)
        with self._lock:
            self._nodes.append(entry)
            self._announce()
        return entry

    def remove_node(self, entry: NodeEntry) -> None:
        """Announce that a node is gone."""
        with self._lock:
            if entry in self._nodes:
                self._nodes.remove(entry)
                self._announce()

    def create_writer(
        self,
        node: NodeEntry,
        dds_topic: str,
        type_name: str,
        settings: QosSettings,
        *,
        service: bool = False,
        identity: dict[str, str] | None = None,
        callbacks: dict[str, Callable[..., None]] | None = None,
    ) -> Writer:
        """Create a writer of a node's and announce it."""
        writer = Writer(
            self._entity,
            dds_topic,
            topic_type(type_name, service=service),
            settings,
            _announced(type_name, identity),
            **(callbacks or {}),
        )
        with self._lock:
            self._endpoints.append(writer)
            node.writer_gids.append(writer.gid)
            self._announce()
        return writer

    def create_reader(
        self,
        node: NodeEntry,
        dds_topic: str,
        type_name: str,
        settings: QosSettings,
        on_data: Callable[[], None],
        *,
        service: bool = False,
        identity: dict[str, str] | None = None,
        callbacks: dict[str, Callable[..., None]] | None = None,
    ) -> Reader:
        """Create a reader of a node's and announce it."""
        reader = Reader(
            self._entity,
            dds_topic,
            topic_type(type_name, service=service),
            settings,
            _announced(type_name, identity),
            on_data,
            **(callbacks or {}),
        )
        with self._lock:
            self._endpoints.append(reader)
            node.reader_gids.append(reader.gid)
            self._announce()
        return reader

    def remove_endpoint(self, node: NodeEntry, endpoint: Reader | Writer) -> None:
        """Close an endpoint and announce that it is gone."""
        with self._lock:
            if endpoint not in self._endpoints:
                return
            self._endpoints.remove(endpoint)
            gids = node.writer_gids if isinstance(endpoint, Writer) else node.reader_gids
            gids.remove(endpoint.gid)
            self._announce()
        endpoint.close()

    def _announce(self) -> None:
        if self._closed:
            return
        gid_class = message_class("rmw_dds_common/msg/Gid")
        node_class = message_class("rmw_dds_common/msg/NodeEntitiesInfo")

        def gid(raw: bytes) -> Any:
            return gid_class(data=np.frombuffer(raw, np.uint8))

        sample = self._info(
            gid=gid(self.gid),
            node_entities_info_seq=[
                node_class(
                    node_namespace=node.namespace,
                    node_name=node.name,
                    reader_gid_seq=[gid(raw) for raw in node.reader_gids],
                    writer_gid_seq=[gid(raw) for raw in node.writer_gids],
                )
                for node in self._nodes
            ],
        )
        self._announcer.write(type(sample)._TYPE_SUPPORT.serialize(sample))

    def close(self) -> None:
        """Take everything apart in the order that the library survives."""
        with self._lock:
            if self._closed:
                return
            self._closed = True
            endpoints, self._endpoints = self._endpoints, []
        for endpoint in (*endpoints, self._discovery, self._announcer):
            if endpoint is not None:
                endpoint.close()
        self.graph.close()
        delete_entity(self._entity)
        _close_domain(self.domain_id)
        _open.discard(self)


@atexit.register
def _close_all() -> None:
    for participant in tuple(_open):
        participant.close()


def _announced(type_name: str, identity: dict[str, str] | None) -> bytes:
    type_hash = message_class(type_name)._TYPE_SUPPORT.hash
    return user_data.endpoint_user_data(type_hash, **(identity or {}))
