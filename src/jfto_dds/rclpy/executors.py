"""Executors: they wait for work and run the callbacks of nodes.

Nothing is polled: data, triggers and finished callbacks wake the executor, and otherwise it
sleeps until the next timer is due.
"""

from __future__ import annotations

import inspect
import os
import threading
import time
import warnings
import weakref
from collections import deque
from collections.abc import Callable, Coroutine, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from ._wake_up import WakeUp
from .task import Future, Task
from .utilities import get_default_context


class TimeoutException(Exception):
    """Waiting took too long."""


class ShutdownException(Exception):
    """The executor was shut down."""


class ExternalShutdownException(Exception):
    """The context was shut down."""


class ConditionReachedException(Exception):
    """What was waited for has happened."""


class TimeoutObject:
    """A time-out that changes while it is used."""

    def __init__(self, timeout: float) -> None:
        self.timeout = timeout


async def await_or_execute(callback: Callable | Coroutine, *args: Any) -> Any:
    """Await a coroutine or call a function."""
    if inspect.iscoroutinefunction(callback):
        return await callback(*args)
    return callback(*args)  # type: ignore[operator]


class Executor:
    """Base of the executors: finds out what is ready, and in which order."""

    def __init__(self, *, context: Any = None) -> None:
        self._context = get_default_context() if context is None else context
        if self._context.handle is None or not self._context.ok():
            # rclpy's own text for a context that is not there.
            msg = "'NoneType' object does not support the context manager protocol"
            raise TypeError(msg)
        self._nodes: dict[Any, None] = {}
        self._nodes_lock = threading.RLock()
        self._wake_up = WakeUp()
        self._is_shutdown = False
        self._tasks: deque[Task] = deque()
        self._failures: deque[BaseException] = deque()
        self._candidates: Iterator[tuple[Any, Any]] = iter(())
        self._context.on_shutdown(self.wake)

    @property
    def context(self) -> Any:
        """The context that the executor belongs to."""
        return self._context

    def wake(self) -> None:
        """Look again at what is ready."""
        self._wake_up.set()

    def create_task(self, callback: Callable | Coroutine, *args: Any, **kwargs: Any) -> Task:
        """Run a callback or coroutine in this executor."""
        task = Task(callback, args, kwargs, executor=self)
        self._tasks.append(task)
        self.wake()
        return task

    def add_node(self, node: Any) -> bool:
        """Take charge of a node's callbacks; False where it is in charge already."""
        with self._nodes_lock:
            if node in self._nodes:
                return False
            self._nodes[node] = None
        node.executor = self
        self.wake()
        return True

    def remove_node(self, node: Any) -> None:
        """Leave a node's callbacks alone."""
        with self._nodes_lock:
            if node not in self._nodes:
                return
            del self._nodes[node]
        if node.executor is self:
            node.executor = None
        self.wake()

    def get_nodes(self) -> list[Any]:
        """The nodes in charge of."""
        with self._nodes_lock:
            return list(self._nodes)

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Stop; what runs may end. True once that is so."""
        del timeout_sec
        self._is_shutdown = True
        self.wake()
        for node in self.get_nodes():
            self.remove_node(node)
        return True

    def __enter__(self) -> Executor:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.shutdown()

    def spin(self) -> None:
        """Run callbacks until shutdown."""
        while self._context.ok() and not self._is_shutdown:
            self.spin_once()

    def spin_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        """Run callbacks until a future is done or the time-out passes."""
        future._on_wake(self.wake)
        endless = timeout_sec is None or timeout_sec < 0
        end = None if endless else time.monotonic() + (timeout_sec or 0.0)
        while self._context.ok() and not future.done() and not self._is_shutdown:
            left = None if end is None else max(0.0, end - time.monotonic())
            self._spin_once(left, future.done)
            if end is not None and time.monotonic() >= end:
                return

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Wait for one callback and run it; None and negative wait for ever."""
        self._spin_once(timeout_sec, lambda: False)

    def spin_once_until_future_complete(
        self, future: Future, timeout_sec: float | TimeoutObject | None = None
    ) -> None:
        """Wait for one callback and run it, or for a future to be done."""
        future._on_wake(self.wake)
        if isinstance(timeout_sec, TimeoutObject):
            timeout_sec = timeout_sec.timeout
        self._spin_once(timeout_sec, future.done)

    def _spin_once(self, timeout_sec: float | None, condition: Callable[[], bool]) -> None:
        raise NotImplementedError

    def _groups_of(self, nodes: list[Any]) -> Iterator[tuple[Any, Any]]:
        """All entities in the order in which rclpy looks at them."""
        for node in nodes:
            for waitable in tuple(node.waitables):
                yield waitable, node
        for node in nodes:
            for kind in (node._timers, node._subscriptions, node._guards):
                for entity in tuple(kind):
                    yield entity, node
            for kind in (node._clients, node._services):
                for entity in tuple(kind):
                    yield entity, node

    def _ready_entities(self) -> list[tuple[Any, Any]]:
        return [
            (entity, node)
            for entity, node in self._groups_of(self.get_nodes())
            if entity._is_ready() and entity.callback_group.can_execute(entity)
        ]

    def _claim(self, entity: Any, node: Any) -> Callable[[], None] | None:
        """Take an entity's data and the right to run its callback; None where there is none."""
        if node not in self._nodes or not entity.callback_group.beginning_execution(entity):
            return None
        try:
            call = entity._take()
        except BaseException:
            entity.callback_group.ending_execution(entity)
            raise
        if call is None:
            entity.callback_group.ending_execution(entity)
            return None
        return lambda: self._run(entity, call)

    def _run(self, entity: Any, call: Callable[[], Any]) -> None:
        try:
            result = call()
        except BaseException:
            self._end(entity)
            raise
        if not inspect.iscoroutine(result):
            self._end(entity)
            return
        # The group stays taken until the coroutine ends.
        task = Task(result, executor=self)
        task._on_wake(lambda: self._end(entity))
        self._run_task(task)

    def _end(self, entity: Any) -> None:
        entity.callback_group.ending_execution(entity)
        self.wake()

    def _run_task(self, task: Task) -> None:
        task()
        if task.done():
            task.result()
            return
        if task.cancelled():
            return
        awaited = task._waiting_for
        if isinstance(awaited, Future):
            awaited._on_wake(lambda: self._requeue(task))
        else:
            self._requeue(task)

    def _requeue(self, task: Task) -> None:
        self._tasks.append(task)
        self.wake()

    def _next_in_line(self) -> Callable[[], None] | None:
        while self._tasks:
            task = self._tasks.popleft()
            if task._pending():
                return lambda: self._run_task(task)
        for entity, node in self._candidates:
            work = self._claim(entity, node)
            if work is not None:
                return work
        return None

    def _wait_for_work(
        self, timeout_sec: float | None, condition: Callable[[], bool]
    ) -> Callable[[], None]:
        """Wait until there is something to run and return it.

        Raises
        ------
        ShutdownException, ExternalShutdownException, ConditionReachedException, TimeoutException
            What ended the wait instead.
        """
        endless = timeout_sec is None or timeout_sec < 0
        end = None if endless else time.monotonic() + (timeout_sec or 0.0)
        while True:
            if self._is_shutdown:
                raise ShutdownException
            if self._failures:
                raise self._failures.popleft()
            if not self._context.ok():
                raise ExternalShutdownException
            if condition():
                raise ConditionReachedException
            work = self._next_in_line()
            if work is not None:
                return work
            ready = self._ready_entities()
            if ready:
                self._candidates = iter(ready)
                continue
            wait_s = self._next_timer_s()
            if end is not None:
                left = end - time.monotonic()
                if left <= 0:
                    raise TimeoutException
                wait_s = left if wait_s is None else min(wait_s, left)
            self._wake_up.wait(wait_s)

    def _next_timer_s(self) -> float | None:
        waits = [
            wait
            for node in self.get_nodes()
            for timer in tuple(node._timers)
            if timer.callback_group.can_execute(timer)
            and (wait := timer._wall_wait_s()) is not None
        ]
        return min(waits) if waits else None


class SingleThreadedExecutor(Executor):
    """Runs callbacks in the thread that spins."""

    def _spin_once(self, timeout_sec: float | None, condition: Callable[[], bool]) -> None:
        try:
            work = self._wait_for_work(timeout_sec, condition)
        except (ShutdownException, TimeoutException, ConditionReachedException):
            return
        work()


class MultiThreadedExecutor(Executor):
    """Runs callbacks in a pool of threads."""

    def __init__(self, num_threads: int | None = None, *, context: Any = None) -> None:
        super().__init__(context=context)
        if num_threads is None:
            num_threads = len(os.sched_getaffinity(0)) or 2
        if num_threads == 1:
            warnings.warn(
                "MultiThreadedExecutor is used with a single thread.\n"
                "Use the SingleThreadedExecutor instead.",
                stacklevel=2,
            )
        self._executor = ThreadPoolExecutor(num_threads)
        self._finalizer = weakref.finalize(self, self._executor.shutdown, wait=False)

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        stopped = super().shutdown(timeout_sec)
        self._executor.shutdown(wait=False)
        return stopped

    def _spin_once(self, timeout_sec: float | None, condition: Callable[[], bool]) -> None:
        try:
            work = self._wait_for_work(timeout_sec, condition)
        except (
            ExternalShutdownException,
            ShutdownException,
            TimeoutException,
            ConditionReachedException,
        ):
            return
        try:
            self._executor.submit(self._run_and_report, work)
        except RuntimeError:
            # The pool was closed by shutdown() meanwhile; anything else is an error.
            if not self._is_shutdown:
                raise

    def _run_and_report(self, work: Callable[[], None]) -> None:
        try:
            work()
        except BaseException as error:  # noqa: BLE001 - raised again by the thread that spins
            self._failures.append(error)
            self.wake()
