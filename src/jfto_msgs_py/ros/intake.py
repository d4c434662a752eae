"""Messages from others: decoded, or counted and logged where they break their contract."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

from jfto_msgs_py.errors import MessageError

Record = TypeVar("Record")
_INDEX = re.compile(r"\[\d+\]")
_LOG_EVERY_S = 5.0


@dataclass(frozen=True)
class Input:
    """What is taken from a topic: the class of its messages, their QoS, and where records go.

    `decode` makes a record of a message, `take` takes it over with the time at which it came (ns
    since the epoch); both raise MessageError for what cannot be.
    """

    kind: type
    topic: str
    qos: Any
    decode: Callable[[Any], Any]
    take: Callable[[Any, int], None]


class Intake:
    """Decodes messages of one node; a malformed one is an entry in `counts`, never a crash.

    `counts` is by topic and field, indices left out.
    """

    def __init__(self, logger: Any) -> None:
        self._logger = logger
        self.counts: Counter[tuple[str, str]] = Counter()

    def take(self, topic: str, decode: Callable[[Any], Record], message: Any) -> Record | None:
        """The record in a message; None where there is none."""
        try:
            return decode(message)
        except MessageError as error:
            self.refuse(topic, error)
            return None

    def hand_over(self, each: Input, message: Any, now_ns: int) -> bool:
        """Decode a message and hand its record over; False where it was refused."""
        try:
            each.take(each.decode(message), now_ns)
        except MessageError as error:
            self.refuse(each.topic, error)
            return False
        return True

    def refuse(self, topic: str, error: MessageError) -> None:
        """Count a message that was found wrong after it was decoded."""
        self.counts[topic, _INDEX.sub("[]", error.field)] += 1
        self._logger.warning(
            f"Dropped a message on {topic}: {error}", throttle_duration_sec=_LOG_EVERY_S
        )

    def facts(self, prefix: str) -> dict[str, str]:
        """Counts for diagnostics, of the topics that begin with `prefix`."""
        return {
            f"malformed {topic} {field}": str(count)
            for (topic, field), count in sorted(self.counts.items())
            if topic.startswith(prefix)
        }
