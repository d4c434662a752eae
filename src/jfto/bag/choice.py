"""Which topics are recorded."""

from __future__ import annotations

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Choice:
    """Topics that are named, or match, or all of them."""

    topics: frozenset[str] = frozenset()
    pattern: re.Pattern[str] | None = None
    everything: bool = False
    excluded: frozenset[str] = frozenset()

    @property
    def is_open_ended(self) -> bool:
        """Whether topics that nobody knows of yet may be wanted."""
        return self.everything or self.pattern is not None

    def wants(self, topic: str) -> bool:
        """Whether a topic is to be recorded."""
        if topic in self.excluded:
            return False
        matches = self.pattern is not None and self.pattern.search(topic) is not None
        return topic in self.topics or self.everything or matches
