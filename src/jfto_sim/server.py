"""Several vehicles on UDP and TCP, in wall time times a speed-up: the thin shell of `Vehicle`."""

from __future__ import annotations

import math
import selectors
import socket
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from queue import Empty, SimpleQueue
from typing import Any

from jfto_msgs_py.errors import InputError, JftoError
from jfto_sim import control
from jfto_sim.air import FleetAir
from jfto_sim.config import VehicleConfig
from jfto_sim.endpoint import Endpoints
from jfto_sim.motion.waypoint_nav import warm_up
from jfto_sim.station import Station
from jfto_sim.vehicle import Vehicle

_TICK_S, _STEP_MAX_S = 0.005, 0.5
_CONTROL_BYTES = 512
TCP_BASE, UDP_BASE, PORT_STEP = 5760, 14560, 10


@dataclass(frozen=True)
class ServerSettings:
    """`endpoints[k]` are the ports of vehicle k, SERIAL0 first; `control_port` 0 takes any.

    The vehicles have been on for `uptime_s` when they are first heard.
    """

    endpoints: tuple[tuple[str, ...], ...]
    speedup: float = 1.0
    seed: int = 0
    faults: tuple[str, ...] = ()
    control_port: int | None = None
    uptime_s: float = 0.0


def default_endpoints(count: int, host: str = "127.0.0.1") -> tuple[tuple[str, ...], ...]:
    """SERIAL0 on TCP 5760 + 10 k as ArduPilot's simulation has it, SERIAL1 on UDP 14560 + 10 k."""
    return tuple(
        (f"tcp:{host}:{TCP_BASE + PORT_STEP * k}", f"udp:{host}:{UDP_BASE + PORT_STEP * k}")
        for k in range(count)
    )


class SimServer:
    """Runs vehicles in one thread of its own; everything else talks to them through `call`.

    They are numbered from 1 in their order; two may have one system id, as on a real link.
    `air`, where given, lies between the radios of all vehicles in their order. `pace`, where given,
    is asked before each step, in the server's thread, with the seconds that have passed since the
    last one: by how many seconds the vehicles' time may go on, however fast it is to pass.
    """

    def __init__(
        self,
        configs: Sequence[VehicleConfig],
        settings: ServerSettings,
        air: FleetAir | None = None,
        pace: Callable[[SimServer, float], float] | None = None,
    ) -> None:
        if not settings.speedup > 0:
            raise InputError(f"speedup is {settings.speedup}, must be positive.")
        if len(configs) != len(settings.endpoints):
            raise InputError(
                f"{len(configs)} vehicles but endpoints for {len(settings.endpoints)}."
            )
        self.settings = settings
        self.air = air
        self._pace = pace
        self.stations: dict[int, Station] = {}
        self._calls: SimpleQueue[tuple[Callable[[], Any], Future[Any]]] = SimpleQueue()
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None
        self._control: socket.socket | None = None
        warm_up()
        opening = Endpoints()
        try:
            for number, config in enumerate(configs, 1):
                vehicle = Vehicle(config)
                vehicle.params.store("SIM_SPEEDUP", settings.speedup)
                vehicle.advance(settings.uptime_s)
                texts = settings.endpoints[number - 1]
                seed = settings.seed + number
                self.stations[number] = Station(vehicle, texts, seed, opening)
            if settings.control_port is not None:
                self._control = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
                self._control.setblocking(False)
                self._control.bind(("127.0.0.1", settings.control_port))
            for line in settings.faults:
                control.apply(self.stations, line, air)
        except JftoError:
            self._close()
            raise

    def addresses(self, number: int) -> list[tuple[str, int]]:
        """Host and port of each endpoint of a vehicle."""
        return [endpoint.address for endpoint in self.stations[number].endpoints]

    @property
    def control_address(self) -> tuple[str, int] | None:
        """Where fault lines are taken, if anywhere."""
        if self._control is None:
            return None
        host, port = self._control.getsockname()
        return host, port

    @property
    def elapsed_s(self) -> float:
        """Seconds of the vehicles' time since they were made, restarts included."""
        return max(station.vehicle.total_s for station in self.stations.values())

    @property
    def armed(self) -> bool:
        """Whether a vehicle is armed."""
        vehicles = (station.vehicle for station in self.stations.values())
        return any(vehicle.flight.motors.armed and not vehicle.dead for vehicle in vehicles)

    def run(self) -> None:
        """Serve until `stop`; blocks."""
        before = time.monotonic()
        try:
            while not self._stop.is_set():
                self._wait()
                now = time.monotonic()
                elapsed, before = now - before, now
                self._run_calls()
                self._read_control()
                most_s = math.inf if self._pace is None else self._pace(self, elapsed)
                for station in self.stations.values():
                    speed = max(station.vehicle.params["SIM_SPEEDUP"], 0.01)
                    station.step(min(elapsed * speed, _STEP_MAX_S * speed, most_s))
                if self.air is not None:
                    self.air.step([station.vehicle for station in self.stations.values()])
        finally:
            self._close()

    def _wait(self) -> None:
        with selectors.DefaultSelector() as waiting:
            for station in self.stations.values():
                for endpoint in station.endpoints:
                    for sock in endpoint.sockets():
                        waiting.register(sock, selectors.EVENT_READ)
            waiting.select(_TICK_S)

    def _run_calls(self) -> None:
        while True:
            try:
                function, future = self._calls.get_nowait()
            except Empty:
                return
            try:
                future.set_result(function())
            except JftoError as error:
                future.set_exception(error)

    def _read_control(self) -> None:
        if self._control is None:
            return
        while True:
            try:
                data, peer = self._control.recvfrom(_CONTROL_BYTES)
            except (BlockingIOError, ConnectionError):
                return
            try:
                said = control.apply(self.stations, data.decode("utf-8", "replace"), self.air)
                answer = f"ok {said}".rstrip()
            except JftoError as error:
                answer = f"error: {error}"
            self._control.sendto(answer.encode(), peer)

    def call(self, function: Callable[[], Any], timeout_s: float = 10.0) -> Any:
        """Run a function in the server's thread and return its result."""
        future: Future[Any] = Future()
        self._calls.put((function, future))
        return future.result(timeout_s)

    def fault(self, line: str) -> None:
        """Carry out a fault line of `control`."""
        self.call(lambda: control.apply(self.stations, line, self.air))

    def start(self) -> SimServer:
        """Serve in a thread."""
        self._thread = threading.Thread(target=self.run, name="jfto_sim", daemon=True)
        self._thread.start()
        return self

    def stop(self) -> None:
        """End serving and close the sockets."""
        self._stop.set()
        if self._thread is not None:
            self._thread.join()

    def _close(self) -> None:
        for station in self.stations.values():
            station.close()
        if self._control is not None:
            self._control.close()

    def __enter__(self) -> SimServer:
        return self.start()

    def __exit__(self, *_: object) -> None:
        self.stop()


__all__ = ["ServerSettings", "SimServer", "Station", "default_endpoints"]
