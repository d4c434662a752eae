"""One fixture for both kinds of vehicle: `jfto_sim`, or a real ArduCopter where there is one.

`JFTO_ARDUCOPTER=/path/to/arducopter` chooses the real one. A test that takes `vehicles` gets
addresses to give to a program, one that takes `pilots` flies by hand; neither can tell which
vehicle it has unless it asks.
"""

from __future__ import annotations

import socket
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from jfto.simulation.fleet import UPTIME_S
from jfto_sim import Vehicle, VehicleConfig
from jfto_sim.config import fleet
from jfto_sim.server import ServerSettings, SimServer
from support.arducopter import LINK, PILOT, ArduCopter, binary
from support.live_pilot import LivePilot
from support.pilot import Pilot

SPEEDUP = 8.0


@dataclass
class Vehicles:
    """Vehicles that run; `links` are what `--vehicles` takes, one each or one for all.

    `server` has the simulated ones and is None for real ones.
    """

    configs: Sequence[VehicleConfig]
    links: Sequence[str]
    server: SimServer | None
    _real: Sequence[ArduCopter]
    _closing: ExitStack

    @property
    def real(self) -> bool:
        """Whether they are ArduCopter itself."""
        return self.server is None

    @property
    def text(self) -> str:
        """All links as `--vehicles` takes them."""
        return ",".join(self.links)

    def pilot(self, number: int) -> LivePilot:
        """A hand on vehicle `number` (from 1), on a port that nobody else uses."""
        if self.server is None:
            address = ("127.0.0.1", self._real[number - 1].port(PILOT))
        else:
            address = self.server.addresses(number)[1]
        pilot = LivePilot(address, real=self.real, sysid=self.configs[number - 1].sysid)
        self._closing.callback(pilot.close)
        return pilot

    def kill(self, number: int) -> None:
        """Power vehicle `number` (from 1) off."""
        if self.server is None:
            self._real[number - 1].kill()
        else:
            self.server.fault(f"kill {number}")


@dataclass
class Starter:
    """Starts vehicles as a test asks for them; ends them with the test."""

    folder: Path
    closing: ExitStack

    def __call__(
        self,
        configs: Sequence[VehicleConfig] | int = 1,
        *,
        parameters: Mapping[str, float] | None = None,
        speedup: float = SPEEDUP,
        shared: bool = False,
    ) -> Vehicles:
        """Start vehicles as `configs` have them, or so many in a row; `parameters` are all's.

        `shared` lets all send to one UDP link, as radios of one net do.
        """
        if isinstance(configs, int):
            configs = fleet(configs)
        configs = [replace(c, parameters={**c.parameters, **(parameters or {})}) for c in configs]
        remote = f"127.0.0.1:{_free_udp_port()}" if shared else ""
        start = self._simulated if binary() is None else self._flown
        vehicles = start(configs, speedup, remote)
        if shared:
            vehicles.links = [f"udpin:{remote}"]
        return vehicles

    def _flown(self, configs: list[VehicleConfig], speedup: float, remote: str) -> Vehicles:
        started = []
        for config in configs:
            number = len(list(self.folder.iterdir()))
            folder = self.folder / f"arducopter_{number}"
            started.append(ArduCopter.start(config, folder, number, speedup, remote))
            self.closing.callback(started[-1].kill)
        links = [] if remote else [f"tcp:127.0.0.1:{one.port(LINK)}" for one in started]
        return Vehicles(configs, links, None, started, self.closing)

    def _simulated(self, configs: list[VehicleConfig], speedup: float, remote: str) -> Vehicles:
        link = f"udpto:{remote}" if remote else "tcp:127.0.0.1:0"
        endpoints = ((link, "tcp:127.0.0.1:0"),) * len(configs)
        settings = ServerSettings(endpoints, speedup, uptime_s=UPTIME_S)
        server = SimServer(configs, settings)
        self.closing.enter_context(server)
        numbers = range(1, len(configs) + 1)
        links = [f"tcp:127.0.0.1:{server.addresses(n)[0][1]}" for n in numbers]
        return Vehicles(configs, links, server, (), self.closing)


def _free_udp_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@pytest.fixture
def vehicles(tmp_path: Path) -> Iterator[Starter]:
    """Starts vehicles that a program can be let loose on."""
    folder = tmp_path / "vehicles"
    folder.mkdir()
    with ExitStack() as closing:
        yield Starter(folder, closing)


@pytest.fixture
def pilots(vehicles: Starter) -> Callable[..., Pilot]:
    """Starts one vehicle with the parameters named and puts a pilot on its second port.

    The simulated one runs in simulated time, as fast as it can.
    """

    def start(config: VehicleConfig | None = None, **parameters: float) -> Pilot:
        config = config or VehicleConfig()
        config = replace(config, parameters={**config.parameters, **parameters})
        if binary() is None:
            return Pilot(Vehicle(config), port=1)
        return vehicles([config]).pilot(1)

    return start


simulated_only = pytest.mark.skipif(
    binary() is not None, reason="asks for what only the simulated vehicle can be made to do"
)
