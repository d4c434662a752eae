"""`jfto mission order` to a bridge that runs on this computer: nothing else is loaded for it."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from jfto_msgs_py.order_socket import VERBS, send_order


def quick_order(arguments: Sequence[str]) -> int | None:
    """Exit status of `jfto ARGUMENTS`, None where that is more than one order to all."""
    if list(arguments[:2]) != ["mission", "order"] or len(arguments) != 3:
        return None
    return order_bridge(arguments[2]) if arguments[2] in VERBS else None


def order_bridge(verb: str) -> int:
    """Give the order, say what came of it; returns the exit status. Raises InputError."""
    success, text = send_order(verb)
    print(text, file=sys.stdout if success else sys.stderr)
    return 0 if success else 1
