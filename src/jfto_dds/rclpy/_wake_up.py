"""A wake-up call that is safe to give from anywhere, signal handlers included."""

from __future__ import annotations

import _thread
import contextlib


class WakeUp:
    """Lets one thread wait until another calls :meth:`set`.

    ``threading.Event`` takes a lock in ``set``; a signal handler that interrupts the owner of
    that lock would wait for itself. This is a bare lock used as a binary semaphore, which also
    wakes faster.
    """

    def __init__(self) -> None:
        self._lock = _thread.allocate_lock()
        self._lock.acquire()

    def set(self) -> None:
        """Wake the waiting thread, or the next one that waits."""
        # Releasing what nobody holds: a wake-up is pending already.
        with contextlib.suppress(RuntimeError):
            self._lock.release()

    def wait(self, timeout_s: float | None = None) -> bool:
        """Wait for a call since the last wait; False on time-out."""
        if timeout_s is None:
            return self._lock.acquire()
        return self._lock.acquire(timeout=min(max(timeout_s, 0.0), _thread.TIMEOUT_MAX))
