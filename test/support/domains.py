"""ROS domains that a worker has for itself: what one test looks for, no other test's nodes are."""

from __future__ import annotations

import itertools
import os

# Domains above 101 would take ports that Linux gives to others. Eight workers have shares.
_MOST, _SHARE = 100, 12
_WORKER = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))


def _domain(number: int) -> int:
    """Of this worker's share. Workers of one run have one parent; other runs begin elsewhere."""
    return 1 + (os.getppid() * 37 + _WORKER * _SHARE + number) % _MOST


OWN = _domain(0)
_others = itertools.cycle(map(_domain, range(1, _SHARE)))


def next_domain() -> int:
    """Another than the worker's own, and than the last ten that were asked for."""
    return next(_others)
