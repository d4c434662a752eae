"""Life of the client library: initialised, running, shut down."""

from __future__ import annotations

import atexit
import inspect
import sys
import threading
import weakref
from collections.abc import Callable
from typing import Any

from jfto_dds.wire import network
from jfto_dds.wire.participant import Participant

from ._arguments import RosArguments, parse_arguments
from ._logging_backend import backend
from ._rclpy_pybind11 import RCLError
from .impl.logging_severity import LoggingSeverity

_contexts: weakref.WeakSet[Context] = weakref.WeakSet()


class Context:
    """What ``init`` starts and ``shutdown`` ends; owns the DDS participant."""

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._is_initialised = False
        self._is_ok = False
        self._callbacks: list[Any] = []
        self._arguments = RosArguments()
        self._participant: Participant | None = None
        self._domain_id = 0
        self._logging_initialized = False

    @property
    def handle(self) -> Context | None:
        """Stands for rcl's context; None before ``init``."""
        return self if self._is_initialised else None

    def init(
        self,
        args: list[str] | None = None,
        *,
        initialize_logging: bool = True,
        domain_id: int | None = None,
    ) -> None:
        """Initialise with a command line (``sys.argv`` where None) and a domain."""
        with self._lock:
            if self._is_initialised:
                msg = "Context.init() must only be called once"
                raise RuntimeError(msg)
            if network.security_is_wanted():
                msg = (
                    "jfto_dds does not support SROS 2 security (ROS_SECURITY_ENABLE=true): it "
                    "would talk in clear. Unset it, or use a real rclpy"
                )
                raise NotImplementedError(msg)
            if domain_id is not None and domain_id < 0:
                msg = f"Domain id ({domain_id}) should not be lower than zero."
                raise RuntimeError(msg)
            try:
                self._arguments = parse_arguments(sys.argv if args is None else args)
            except RCLError as error:
                if "failed to initialize" in str(error) and "trailing" not in str(error):
                    _log_rcl(LoggingSeverity.ERROR, "Failed to parse global arguments")
                raise
            try:
                self._domain_id = network.domain_id() if domain_id is None else domain_id
            except network.NetworkSettingError as error:
                msg = f"failed to initialize rcl: {error}"
                raise RCLError(msg) from None
            if initialize_logging:
                backend.configure(self._arguments.log_levels, console=self._arguments.console)
                self._logging_initialized = True
            for warning in self._arguments.warnings:
                _log_rcl(LoggingSeverity.WARN, warning)
            self._is_initialised = True
            self._is_ok = True
        _contexts.add(self)

    def ok(self) -> bool:
        """Whether the context is initialised and not shut down."""
        return self._is_ok

    def get_domain_id(self) -> int:
        """The DDS domain."""
        if not self._is_initialised:
            msg = "rclpy.init() has not been called"
            raise RCLError(msg)
        return self._domain_id

    def _get_participant(self) -> Participant:
        with self._lock:
            if self._participant is None:
                self._participant = Participant(self._domain_id, self._arguments.enclave)
            return self._participant

    def _invalidate(self) -> bool:
        """Stop all work without touching DDS; safe in a signal handler. False if done before."""
        if not self._is_ok:
            return False
        self._is_ok = False
        callbacks, self._callbacks = self._callbacks, []
        for reference in callbacks:
            callback = reference() if isinstance(reference, weakref.WeakMethod) else reference
            if callback is not None:
                callback()
        return True

    def _close(self) -> None:
        with self._lock:
            participant, self._participant = self._participant, None
        if participant is not None:
            participant.close()

    def shutdown(self) -> None:
        """End all work and leave the network."""
        if not self._is_initialised:
            msg = "Context must be initialized before it can be shutdown"
            raise RuntimeError(msg)
        if not self._invalidate():
            self._close()
            msg = "failed to shutdown: rcl_shutdown already called on the given context"
            raise RCLError(msg)
        self._close()

    def try_shutdown(self) -> None:
        """Shut down where that has not been done."""
        if self._is_initialised:
            self._invalidate()
            self._close()

    def on_shutdown(self, callback: Callable[[], None]) -> None:
        """Call back when the context is shut down; at once where it already is."""
        if not callable(callback):
            msg = "callback must be a callable, got {}"
            raise TypeError(msg.format(type(callback)))
        if self._is_initialised and not self._is_ok:
            callback()
            return
        is_method = inspect.ismethod(callback)
        self._callbacks.append(weakref.WeakMethod(callback) if is_method else callback)

    def _forget(self, callback: Callable[[], None]) -> None:
        """Take a callback back that was meant for a while only."""
        kept = []
        for reference in self._callbacks:
            known = reference() if isinstance(reference, weakref.WeakMethod) else reference
            if known is not None and known != callback:
                kept.append(reference)
        self._callbacks = kept

    def __enter__(self) -> Context:
        self.init()
        return self

    def __exit__(self, *_exception: object) -> None:
        self.try_shutdown()


def _log_rcl(severity: int, message: str) -> None:
    backend.log(severity, "rcl", message, "", "", 0)


def invalidate_all() -> None:
    """Stop the work of every context, as a signal does."""
    for context in tuple(_contexts):
        context._invalidate()


@atexit.register
def _close_all() -> None:
    # Left to the garbage collector at exit, DDS readers can hang in their finalizers.
    for context in tuple(_contexts):
        context.try_shutdown()
