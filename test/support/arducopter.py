"""A real ArduCopter in simulation, run as a process where JFTO_ARDUCOPTER names its binary.

It begins with the parameters that `jfto_sim` begins with, so that the two can be compared.
"""

from __future__ import annotations

import os
import re
import socket
import subprocess
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from jfto_sim import VehicleConfig
from jfto_sim.parameters import definitions
from support.pilot import PilotError

# Counted or measured by the vehicle itself.
_ITS_OWN = re.compile(
    r"^(STAT_|FORMAT_VERSION|(MIS|FENCE|RALLY)_TOTAL|BARO\d_GND|SIM_SPEEDUP|SYSID_SW|INS_GYR)"
)
_PORTS, _TRIES, _OPENS_WITHIN_S, _ENDS_WITHIN_S = 10, 50, 60.0, 10.0
LINK, PILOT = 0, 2  # ports of SERIAL0 and SERIAL1 above the base


def binary() -> Path | None:
    """The ArduCopter that JFTO_ARDUCOPTER names, None where it names none."""
    named = os.environ.get("JFTO_ARDUCOPTER", "")
    return Path(named).resolve() if named else None


@dataclass
class ArduCopter:
    """One process with a directory of its own; `base` is the first of its ports."""

    config: VehicleConfig
    base: int
    process: subprocess.Popen[bytes]

    @classmethod
    def start(
        cls, config: VehicleConfig, folder: Path, number: int, speedup: float, remote: str = ""
    ) -> ArduCopter:
        """Power it up in an empty folder; SERIAL0 sends to `remote` (HOST:PORT) where given.

        Its identity is made of `number`, which no other may have.
        """
        program = binary()
        assert program is not None, "JFTO_ARDUCOPTER names no binary"
        folder.mkdir(parents=True)
        (folder / "defaults.parm").write_text(
            _defaults({"SYSID_THISMAV": config.sysid, **config.parameters})
        )
        base = _free_base()
        place = (config.home_lat_deg, config.home_lon_deg, config.home_alt_m, config.heading_deg)
        command = [
            program, "--wipe", "--model", "+", "--speedup", f"{speedup:g}",
            "--home", ",".join(f"{value:.8f}" for value in place),
            "--defaults", "defaults.parm",
            "--base-port", str(base), "--rc-in-port", str(base + 5), "--instance", str(number),
            "--serial0", f"udpclient:{remote}" if remote else f"tcp:{LINK}",
            "--serial1", f"tcp:{PILOT}", "--serial2", "tcp:3",
        ]  # fmt: skip
        with (folder / "output.txt").open("wb") as output:
            process = subprocess.Popen(
                command, cwd=folder, stdin=subprocess.DEVNULL, stdout=output, stderr=output
            )
        return cls(config, base, process)

    def port(self, offset: int) -> int:
        """A TCP port of the vehicle, once it is open; raises PilotError where it never is."""
        end_s = time.monotonic() + _OPENS_WITHIN_S
        while time.monotonic() < end_s and self.process.poll() is None:
            if _listens(self.base + offset):
                return self.base + offset
            time.sleep(0.1)
        raise PilotError(f"ArduCopter {self.config.sysid} does not listen on its port {offset}.")

    def kill(self) -> None:
        """Power off at once."""
        self.process.kill()
        self.process.wait(_ENDS_WITHIN_S)


def _listens(port: int) -> bool:
    """Whether a TCP port is being listened on, found without connecting: it serves one client."""
    wanted = f":{port:04X}"
    lines = Path("/proc/net/tcp").read_text().splitlines()[1:]
    return any(line.split()[1].endswith(wanted) and line.split()[3] == "0A" for line in lines)


def _defaults(parameters: Mapping[str, float]) -> str:
    values = {d.name: d.default for d in definitions() if not _ITS_OWN.match(d.name)}
    values.update(parameters)
    return "".join(f"{name} {value:.9g}\n" for name, value in values.items())


def _free_base() -> int:
    """The first of some ports that are free now."""
    for _ in range(_TRIES):
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            base = int(probe.getsockname()[1])
        if base + _PORTS < 65536 and not any(_listens(base + k) for k in range(_PORTS)):
            return base
    raise PilotError("No ports are free for another ArduCopter.")
