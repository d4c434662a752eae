"""Readers and writers of raw CDR bytes, and the order in which DDS entities are taken apart.

Left to the interpreter's end, a reader's finalizer waits for ever in the library about once in
30 to 60 runs. Every entity is therefore deleted by hand: endpoints, then topics, then the
participant.
"""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Callable
from typing import Any, NamedTuple

from cyclonedds._clayer import ddspy_take
from cyclonedds.core import (
    DDSException,
    Entity,
    InstanceState,
    Listener,
    Policy,
    SampleState,
    ViewState,
)
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Sample, Topic

from jfto_dds.wire.qos_settings import QosSettings, to_cyclone
from jfto_dds.wire.user_data import parse_user_data

_ANY = SampleState.Any | ViewState.Any | InstanceState.Any
_INFINITE_NS = 2**63 - 1
# The binding's own write keeps the interpreter locked. A reliable writer that waits for
# acknowledgments would wait for ever: the thread that receives them needs the interpreter for
# our listeners. Calls through ctypes unlock it.
_dds_write = DataWriter._dll_handle.dds_write
_dds_write.argtypes, _dds_write.restype = [ctypes.c_int32, ctypes.c_void_p], ctypes.c_int32
_dds_assert_liveliness = DataWriter._dll_handle.dds_assert_liveliness
_dds_assert_liveliness.argtypes, _dds_assert_liveliness.restype = [ctypes.c_int32], ctypes.c_int32
# The binding converts QoS through class-wide scratch memory; two threads at once corrupt it.
QOS_LOCK = threading.RLock()
_TOPIC_TRIES = 3


class EntityClosedError(Exception):
    """The DDS entity was deleted."""


class Received(NamedTuple):
    """One payload from the network; the time stamp in nanoseconds, the handle of its writer."""

    payload: bytes
    source_timestamp_ns: int
    publication_handle: int


def _settled(list_peers: Callable[[], list[int]]) -> list[int]:
    """Handles of the peers that match.

    The binding counts them before it lists them, and fails where one has joined in between.
    """
    while True:
        try:
            return list_peers()
        except IndexError:
            continue


def _new_topic(participant: Any, dds_topic: str, idl_type: Any) -> Topic:
    """Create a topic; Cyclone's refusal of a good one, seen once in 1840 starts, is not final.

    It came while two processes discovered each other's types, on another thread of the library.
    """
    for _ in range(_TOPIC_TRIES - 1):
        try:
            return Topic(participant, dds_topic, idl_type)
        except DDSException as error:
            if abs(error.code) != DDSException.DDS_RETCODE_BAD_PARAMETER:
                raise
    return Topic(participant, dds_topic, idl_type)


def delete_entity(entity: Entity) -> None:
    """Delete a DDS entity now, so that its finalizer has nothing left to do."""
    reference = entity._ref
    if Entity._entities.pop(reference, None) is not None:
        entity._delete(reference)


class _Endpoint:
    """What readers and writers share: a topic of their own, a gid, orderly closing."""

    def __init__(self) -> None:
        self._entity: Any = None
        self._topic: Any = None
        self._closing = threading.Lock()
        # USER_DATA of matched endpoints, by handle. It never changes, and each look at it costs
        # 140 microseconds and, in the binding, as many bytes that are never given back.
        self._peers: dict[int, dict[str, str]] = {}
        self.gid = b""

    @property
    def is_closed(self) -> bool:
        """Whether the entity is gone."""
        return self._entity is None

    def _require(self) -> Any:
        entity = self._entity
        if entity is None:
            msg = "the DDS entity was deleted"
            raise EntityClosedError(msg)
        return entity

    def _matched_data(self, handles: list[int], look_up: Callable[[int], Any]) -> dict:
        with QOS_LOCK:
            found = {}
            for handle in handles:
                # The binding shows handles signed here and unsigned in samples.
                key = handle % 2**64
                data = self._peers.get(key)
                if data is None:
                    endpoint = look_up(handle)
                    # None: it has left meanwhile.
                    data = None if endpoint is None else _user_data(endpoint)
                if data is not None:
                    found[key] = data
            return found

    def close(self) -> None:
        """Delete endpoint and topic; doing it again changes nothing."""
        with self._closing:
            entity, self._entity = self._entity, None
        if entity is not None:
            delete_entity(entity)
            delete_entity(self._topic)


class Writer(_Endpoint):
    """Sends raw CDR payloads."""

    def __init__(
        self,
        participant: Any,
        dds_topic: str,
        idl_type: Any,
        settings: QosSettings,
        user_data: bytes,
        **callbacks: Callable[..., None],
    ) -> None:
        super().__init__()
        with QOS_LOCK:
            self._topic = _new_topic(participant, dds_topic, idl_type)
            qos = to_cyclone(settings, user_data, writer=True)
            self._entity = DataWriter(participant, self._topic, qos, Listener(**callbacks))
        self.gid = self._entity.guid.bytes
        self.instance_handle: int = self._entity.instance_handle
        self._reference = self._entity._ref

    def write(self, payload: bytes) -> None:
        """Send one payload; raises EntityClosedError or DDSException."""
        self._require()
        padding = -len(payload) % 4
        if padding:
            payload += bytes(padding)
        sample = Sample(ctypes.cast(ctypes.c_char_p(payload), ctypes.c_void_p), len(payload))
        result = _dds_write(self._reference, ctypes.byref(sample))
        if result < 0:
            raise DDSException(result, "while writing")

    def matched_count(self) -> int:
        """Count the readers that match."""
        return len(_settled(self._require().get_matched_subscriptions))

    def matched(self) -> dict[int, dict[str, str]]:
        """USER_DATA of the readers that match, by handle."""
        entity = self._require()
        handles = _settled(entity.get_matched_subscriptions)
        self._peers = self._matched_data(handles, entity.get_matched_subscription_data)
        return self._peers

    def assert_liveliness(self) -> None:
        """Say that the writer is alive, for manual liveliness."""
        result = _dds_assert_liveliness(self._require()._ref)
        if result < 0:
            raise DDSException(result, "while asserting liveliness")

    def wait_for_acknowledgments(self, timeout_ns: int | None) -> bool:
        """Wait until all matched reliable readers have everything; False on time-out."""
        entity = self._require()
        limit = _INFINITE_NS if timeout_ns is None else timeout_ns
        result = entity._wait_for_acks(entity._ref, limit)
        if result == DDSException.DDS_RETCODE_TIMEOUT:
            return False
        if result < 0:
            raise DDSException(result, "while waiting for acknowledgments")
        return True


class Reader(_Endpoint):
    """Receives raw CDR payloads; ``on_data`` is called, in a DDS thread, when some arrive."""

    def __init__(
        self,
        participant: Any,
        dds_topic: str,
        idl_type: Any,
        settings: QosSettings,
        user_data: bytes,
        on_data: Callable[[], None],
        **callbacks: Callable[..., None],
    ) -> None:
        super().__init__()

        def data_available(_reader: Any) -> None:
            on_data()

        with QOS_LOCK:
            self._topic = _new_topic(participant, dds_topic, idl_type)
            qos = to_cyclone(settings, user_data, writer=False)
            listener = Listener(on_data_available=data_available, **callbacks)
            self._entity = DataReader(participant, self._topic, qos, listener)
        self.gid = self._entity.guid.bytes
        self._reference = self._entity._ref

    def take(self, limit: int = 1) -> list[Received]:
        """Take up to ``limit`` payloads; notices without data are skipped."""
        while self._entity is not None:
            samples = ddspy_take(self._reference, _ANY, limit)
            if isinstance(samples, int):
                if self._entity is None:
                    break
                raise DDSException(samples, "while taking")
            if not samples:
                break
            valid = [
                Received(data, info.source_timestamp, info.publication_handle)
                for data, info in samples
                if info.valid_data
            ]
            if valid:
                return valid
        return []

    def matched_count(self) -> int:
        """Count the writers that match."""
        return len(_settled(self._require().get_matched_publications))

    def matched(self) -> dict[int, dict[str, str]]:
        """USER_DATA of the writers that match, by handle."""
        entity = self._require()
        handles = _settled(entity.get_matched_publications)
        self._peers = self._matched_data(handles, entity.get_matched_publication_data)
        return self._peers

    def publication_user_data(self, handle: int) -> dict[str, str] | None:
        """USER_DATA of one matched writer; None where it has left."""
        key = handle % 2**64
        if key not in self._peers:
            self.matched()
        return self._peers.get(key)


def _user_data(endpoint: Any) -> dict[str, str]:
    policy = endpoint.qos[Policy.Userdata]
    return parse_user_data(policy.data) if policy is not None else {}
