"""What SIGINT and SIGTERM do: they end the contexts; SIGINT also raises KeyboardInterrupt."""

from __future__ import annotations

import enum
import signal
import threading
from types import FrameType
from typing import Any

from .context import invalidate_all


class SignalHandlerOptions(enum.IntFlag):
    """Which signals rclpy handles."""

    NO = 0
    SIGINT = 1
    SIGTERM = 2
    ALL = 3


_previous: dict[int, Any] = {}


def _handle(number: int, frame: FrameType | None) -> None:
    invalidate_all()
    previous = _previous.get(number)
    if callable(previous):
        previous(number, frame)


def install_signal_handlers(
    options: SignalHandlerOptions = SignalHandlerOptions.ALL,
) -> None:
    """Put the handlers in place; outside the main thread Python does not allow it."""
    if threading.current_thread() is not threading.main_thread():
        return
    for flag, number in (
        (SignalHandlerOptions.SIGINT, signal.SIGINT),
        (SignalHandlerOptions.SIGTERM, signal.SIGTERM),
    ):
        current = signal.getsignal(number)
        if options & flag and current is not _handle and current is not signal.SIG_IGN:
            _previous[number] = current
            signal.signal(number, _handle)


def get_current_signal_handlers_options() -> SignalHandlerOptions:
    """Say which handlers are in place."""
    options = SignalHandlerOptions.NO
    if signal.SIGINT in _previous:
        options |= SignalHandlerOptions.SIGINT
    if signal.SIGTERM in _previous:
        options |= SignalHandlerOptions.SIGTERM
    return options


def uninstall_signal_handlers() -> None:
    """Put back what was there before."""
    if threading.current_thread() is not threading.main_thread():
        return
    for number, previous in tuple(_previous.items()):
        if signal.getsignal(number) is _handle:
            signal.signal(number, previous)
        del _previous[number]
