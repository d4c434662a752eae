"""Something that takes its time to open, such as links: opened and kept in a thread of its own."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import ExitStack
from typing import Generic, TypeVar

from jfto_msgs_py.errors import JftoError
from jfto_msgs_py.retry import Retry

T = TypeVar("T")
RETRY = Retry(first_s=1.0, ceiling_s=1.0)


class Opening(Generic[T]):
    """Tries `open_all` until it works; `note` says why it has not yet.

    `open_all` puts what is to be closed on the stack that it is given. `said` is called in the
    thread with each new note, and `opened` with what came of it.
    """

    def __init__(
        self,
        open_all: Callable[[ExitStack], T],
        opened: Callable[[T], None],
        said: Callable[[str], None],
    ) -> None:
        self.note = "opening its links"
        self.opened: T | None = None
        self._open_all, self._tell, self._said = open_all, opened, said
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run, name="opening", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Close what is open; returns when it is."""
        self._ending.set()
        self._thread.join()

    def _run(self) -> None:
        for wait_s in RETRY.waits():
            if self._ending.is_set():
                return
            with ExitStack() as stack:
                try:
                    opened = self._open_all(stack)
                except (JftoError, OSError) as error:
                    if str(error) != self.note:
                        self.note = str(error)
                        self._said(self.note)
                else:
                    self.note = ""
                    self.opened = opened
                    self._tell(opened)
                    self._ending.wait()
                    self.opened = None
                    return
            self._ending.wait(wait_s)
