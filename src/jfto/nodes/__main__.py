"""python -m jfto.nodes NAME: run a node as a child of whoever started it."""

from __future__ import annotations

import signal
import sys
from collections.abc import Sequence

from jfto.nodes import NODES
from jfto.supervision.process import die_with_parent


def main(arguments: Sequence[str]) -> int:
    """Run the node that the first argument names."""
    if not arguments or arguments[0] not in NODES:
        print(f"Name a node: {', '.join(NODES)}.", file=sys.stderr)
        return 2
    # A node that is told to stop while it is still being loaded has nothing to keep.
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: sys.exit(0))
    die_with_parent()
    return NODES[arguments[0]](arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
