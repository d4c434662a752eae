"""Eight vehicles on one bridge: its share of a processor core, and how fast commands are answered.

The simulated vehicles run in a process of their own, in real time over UDP on loopback; all speak
to one listening port. Each sends the bridge's usual streams (position and attitude at 10 Hz). What
is measured is this process alone. Figures depend on the computer and on what else it does.

    python bench/bridge.py [--vehicles 8] [--seconds 20] [--commands 400]
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time

import numpy as np

from jfto_mavlink.dialect import mavlink
from jfto_mavlink.fleet.link import FleetLink
from jfto_mavlink.fleet.roster import parse_roster
from jfto_mavlink.io.address import free_udp_port
from jfto_mavlink.protocol.command import request_message
from jfto_mavlink.protocol.exchange import Context, Exchange

SERVER = """
import sys
from jfto_sim import VehicleConfig
from jfto_sim.server import ServerSettings, SimServer
count, port = int(sys.argv[1]), sys.argv[2]
configs = [VehicleConfig(sysid=n + 1) for n in range(count)]
SimServer(configs, ServerSettings(((f"udpto:127.0.0.1:{port}",),) * count)).run()
"""


def timed_command(context: Context) -> Exchange[float]:
    """Seconds from sending a command to its acknowledgement."""
    begun = time.perf_counter()
    yield from request_message(context, mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
    return time.perf_counter() - begun


def main() -> int:
    """Print the figures; the status is 1 if a target is missed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--vehicles", type=int, default=8)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--commands", type=int, default=400)
    options = parser.parse_args()
    port = free_udp_port()
    names = [f"uav{n + 1}" for n in range(options.vehicles)]
    roster = parse_roster([f"{name}={n}@udpin:127.0.0.1:{port}" for n, name in enumerate(names, 1)])
    server = subprocess.Popen([sys.executable, "-c", SERVER, str(options.vehicles), str(port)])
    try:
        with FleetLink(roster) as bridge:
            bridge.wait_heard(30.0)
            time.sleep(3.0)
            counters = bridge.ports[0].counters
            frames, cpu, wall = counters.frames_in, time.process_time(), time.perf_counter()
            time.sleep(options.seconds)
            wall = time.perf_counter() - wall
            share = (time.process_time() - cpu) / wall
            rate = (counters.frames_in - frames) / wall
            rng = np.random.default_rng(0)
            answers: list[float] = []
            while len(answers) < options.commands:
                time.sleep(float(rng.uniform(0.0, 0.03)))
                uav = names[len(answers) % len(names)]
                result = bridge.run({uav: timed_command})[uav]
                if isinstance(result, Exception):
                    raise result
                answers.append(result)
    finally:
        server.terminate()
        server.wait()
    p50, p99 = np.quantile(answers, [0.5, 0.99]) * 1e3
    print(
        f"{options.vehicles} vehicles, {rate:.0f} frames/s: {share:.1%} of one core (target 40 %)"
    )
    print(
        f"command to acknowledgement, {len(answers)} times: median {p50:.1f} ms, "
        f"p99 {p99:.1f} ms, worst {max(answers) * 1e3:.1f} ms (target 50 ms p99)"
    )
    return int(share > 0.4 or p99 > 50.0)


if __name__ == "__main__":
    sys.exit(main())
