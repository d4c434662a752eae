"""What the conductor wants done."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.records.event import ERROR, INFO, WARN


@dataclass(frozen=True)
class Order:
    """Call the mission service of a verb; whatever comes of it is told to the conductor."""

    verb: str


@dataclass(frozen=True)
class Tell:
    """Tell the operator a line; `level` is INFO, WARN or ERROR.

    `known` says that everybody has been told already, by whoever carried the order out.
    """

    text: str
    level: int = INFO
    known: bool = False


@dataclass(frozen=True)
class Ask:
    """Ask the operator for the word that lets the fleet arm."""


Action = Order | Tell | Ask
__all__ = ["ERROR", "INFO", "WARN", "Action", "Ask", "Order", "Tell"]
