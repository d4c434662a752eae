"""A fleet's plan and links, opened and kept in a thread of their own."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import ExitStack
from typing import Generic, TypeVar

from jfto_msgs_py.errors import JftoError

T = TypeVar("T")
RETRY_S = 1.0


class Opening(Generic[T]):
    """Tries `open_all` until it works; `note` says why it has not yet.

    `open_all` puts what is to be closed on the stack that it is given. `said` is called in the
    link's thread with each new note, and `opened` with what came of it.
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
        self._thread = threading.Thread(target=self._run, name="mavlink links", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Close what is open; returns when it is."""
        self._ending.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._ending.is_set():
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
            self._ending.wait(RETRY_S)
