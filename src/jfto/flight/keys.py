"""The keys that give orders to all in flight: h home, l land, p hold, g go on."""

from __future__ import annotations

import os
import select
import sys
import termios
import tty
from typing import Any

# Key: the bridge's service, and the order in words.
ORDERS = {
    "h": ("abort", "home"),
    "l": ("land", "land where they are"),
    "p": ("pause", "hold"),
    "g": ("resume", "go on"),
}
HELP = "Keys in flight: h home, p hold, g go on, l land where they are; Ctrl-C is home too."


class Keys:
    """Use as a context manager; nothing is read where there is no terminal.

    Only from `listen` on keys count: the word that arms is typed in lines.
    """

    def __init__(self) -> None:
        self._before: list[Any] | None = None
        self._pressed = ""

    def __enter__(self) -> Keys:
        return self

    def __exit__(self, *_exception: object) -> None:
        if self._before is not None:
            termios.tcsetattr(sys.stdin, termios.TCSADRAIN, self._before)

    def listen(self) -> None:
        """Take single keys from now on, if there is a terminal."""
        if self._before is None and sys.stdin is not None and sys.stdin.isatty():
            self._before = termios.tcgetattr(sys.stdin)
            tty.setcbreak(sys.stdin.fileno())

    def pending(self) -> bool:
        """Whether a key has been pressed that gives an order."""
        while self._before is not None and select.select([sys.stdin], [], [], 0.0)[0]:
            typed = os.read(sys.stdin.fileno(), 64).decode(errors="ignore")
            if not typed:
                break
            self._pressed += "".join(key for key in typed.lower() if key in ORDERS)
        return bool(self._pressed)

    def take(self) -> str:
        """The key pressed, each once; "" for none."""
        self.pending()
        key, self._pressed = self._pressed[:1], self._pressed[1:]
        return key
