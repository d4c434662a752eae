"""Futures and tasks that executors run."""

from __future__ import annotations

import inspect
import sys
import threading
import warnings
import weakref
from collections.abc import Callable, Coroutine, Generator
from typing import Any


class Future:
    """A result that may come later."""

    def __init__(self, *, executor: Any = None) -> None:
        self._done = False
        self._cancelled = False
        self._result: Any = None
        self._exception: BaseException | None = None
        self._exception_fetched = False
        self._callbacks: list[Callable[[Any], None]] = []
        self._lock = threading.Lock()
        self._executor: Any = None
        self._set_executor(executor)

    def __del__(self) -> None:
        if self._exception is not None and not self._exception_fetched:
            print(
                "The following exception was never retrieved: " + str(self._exception),
                file=sys.stderr,
            )

    def __await__(self) -> Generator[Any, None, Any]:
        while not self._done and not self._cancelled:
            yield self
        return self.result()

    def _pending(self) -> bool:
        return not self._done and not self._cancelled

    def cancel(self) -> None:
        """Cancel; what is done stays done."""
        with self._lock:
            if not self._done:
                self._cancelled = True
        self._schedule_or_invoke_done_callbacks()

    def cancelled(self) -> bool:
        """Whether it was cancelled."""
        return self._cancelled

    def done(self) -> bool:
        """Whether it has a result or an exception."""
        return self._done

    def result(self) -> Any:
        """The result, None where there is none yet; raises the exception it was given."""
        if self._exception is not None:
            self._exception_fetched = True
            raise self._exception
        return self._result

    def exception(self) -> BaseException | None:
        """The exception it was given."""
        self._exception_fetched = True
        return self._exception

    def set_result(self, result: Any) -> None:
        """Complete with a result."""
        with self._lock:
            self._result = result
            self._done = True
            self._cancelled = False
        self._schedule_or_invoke_done_callbacks()

    def set_exception(self, exception: BaseException) -> None:
        """Complete with an exception."""
        with self._lock:
            self._exception = exception
            self._exception_fetched = False
            self._done = True
            self._cancelled = False
        self._schedule_or_invoke_done_callbacks()

    def _set_executor(self, executor: Any) -> None:
        with self._lock:
            self._executor = None if executor is None else weakref.ref(executor)

    def _schedule_or_invoke_done_callbacks(self) -> None:
        with self._lock:
            executor = self._executor() if self._executor is not None else None
            callbacks, self._callbacks = self._callbacks, []
        for callback in callbacks:
            if executor is not None and not isinstance(callback, _Waker):
                executor.create_task(callback, self)
                continue
            try:
                callback(self)
            except Exception as error:  # noqa: BLE001 - a callback must not stop the others
                warnings.warn(f"Unhandled exception in done callback: {error}", stacklevel=2)

    def add_done_callback(self, callback: Callable[[Any], None]) -> None:
        """Call back when done, in the executor where there is one; at once if done already."""
        with self._lock:
            if not self._done:
                self._callbacks.append(callback)
                return
            executor = self._executor() if self._executor is not None else None
        if executor is not None:
            executor.create_task(callback, self)
        else:
            callback(self)

    def _on_wake(self, wake: Callable[[], None]) -> None:
        """Call ``wake`` when something changes, past any executor: for tasks that wait."""
        with self._lock:
            if self._pending():
                self._callbacks.insert(0, _Waker(wake))
                return
        wake()


class _Waker:
    """A done callback that never needs an executor."""

    def __init__(self, wake: Callable[[], None]) -> None:
        self._wake = wake

    def __call__(self, _future: Any) -> None:
        self._wake()


class Task(Future):
    """A callback or coroutine that an executor runs step by step."""

    def __init__(
        self,
        handler: Callable | Coroutine,
        args: tuple | None = None,
        kwargs: dict | None = None,
        executor: Any = None,
    ) -> None:
        super().__init__(executor=executor)
        self._handler: Any = handler
        self._args = args or ()
        self._kwargs = kwargs or {}
        if inspect.iscoroutinefunction(handler):
            self._handler = handler(*self._args, **self._kwargs)
            self._args, self._kwargs = (), {}
        self._executing = False
        self._task_lock = threading.Lock()
        self._waiting_for: Any = None

    def __call__(self) -> None:
        """Run until done or until it awaits something that is not there yet."""
        if self._done or self._executing or not self._task_lock.acquire(blocking=False):
            return
        try:
            if self._done:
                return
            self._executing = True
            if inspect.iscoroutine(self._handler):
                try:
                    self._waiting_for = self._handler.send(None)
                except StopIteration as stop:
                    self._handler.close()
                    self.set_result(stop.value)
                except Exception as error:  # noqa: BLE001 - handed to who asks for the result
                    self.set_exception(error)
            else:
                try:
                    self.set_result(self._handler(*self._args, **self._kwargs))
                except Exception as error:  # noqa: BLE001 - handed to who asks for the result
                    self.set_exception(error)
        finally:
            self._executing = False
            self._task_lock.release()

    def executing(self) -> bool:
        """Whether it runs right now."""
        return self._executing

    def cancel(self) -> None:
        """Cancel; a coroutine that has not finished is closed."""
        if self._pending() and inspect.iscoroutine(self._handler) and not self._executing:
            self._handler.close()
        super().cancel()
