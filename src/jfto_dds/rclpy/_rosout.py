"""Publishing a node's log records on ``/rosout``."""

from __future__ import annotations

from typing import Any

from builtin_interfaces.msg import Time as TimeMsg
from cyclonedds.core import DDSException
from rcl_interfaces.msg import Log

from jfto_dds.wire import names
from jfto_dds.wire.entities import EntityClosedError
from jfto_dds.wire.qos_settings import QosSettings

from ._logging_backend import backend

_SETTINGS = QosSettings(depth=1000, transient_local=True, lifespan_ns=10 * 10**9)


def attach_rosout(node: Any) -> None:
    """Publish what a node's logger and its children log."""
    support = Log._TYPE_SUPPORT
    writer = node._participant.create_writer(
        node._entry, names.topic_name("/rosout"), support.full_name, _SETTINGS
    )
    node._rosout = writer

    def publish(
        stamp_ns: int, level: int, name: str, text: str, file: str, function: str, line: int
    ) -> None:
        seconds, nanoseconds = divmod(stamp_ns, 10**9)
        record = Log(
            stamp=TimeMsg(sec=seconds, nanosec=nanoseconds),
            level=int(level),
            name=name,
            msg=text,
            file=file,
            function=function,
            line=line,
        )
        try:
            writer.write(support.serialize(record))
        except (DDSException, EntityClosedError):
            # Shutting down: the console has the message, and logging must not fail.
            backend.remove_sink(node._logger_name())

    backend.add_sink(node._logger_name(), publish)


def detach_rosout(node: Any) -> None:
    """Stop publishing a node's log records."""
    writer = getattr(node, "_rosout", None)
    if writer is not None:
        backend.remove_sink(node._logger_name())
        node._remove_endpoint(writer)
        node._rosout = None
