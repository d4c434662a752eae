"""jfto sim."""

from __future__ import annotations

from typing import Any

import click

_PLACE_PARTS = 3


def _home(text: str) -> tuple[float, float, float]:
    from jfto_msgs_py.errors import InputError

    parts = text.split(",")
    try:
        values = [float(part) for part in parts]
    except ValueError:
        values = []
    if len(values) != _PLACE_PARTS:
        raise InputError(f"--home is '{text}', must be LAT,LON,HEIGHT in degrees and metres.")
    return values[0], values[1], values[2]


def _parameters(texts: tuple[str, ...]) -> dict[str, float]:
    from jfto_msgs_py.errors import InputError

    found = {}
    for text in texts:
        name, sign, value = text.partition("=")
        try:
            found[name] = float(value)
        except ValueError:
            raise InputError(f"--param is '{text}', must be NAME=NUMBER.") from None
        if not sign:
            raise InputError(f"--param is '{text}', must be NAME=NUMBER.")
    return found


@click.command("sim")
@click.option("--vehicles", type=click.IntRange(1), default=1, metavar="N", help="How many. [1]")
@click.option("--speedup", type=float, default=1.0, metavar="X", help="Times real time. [1]")
@click.option(
    "--home",
    default="47.397742,8.545594,488.1",
    metavar="LAT,LON,H",
    help="Where vehicle 1 stands; the others stand in a row to the east.",
)
@click.option("--spacing", type=float, default=10.0, metavar="M", help="Metres between them. [10]")
@click.option("--host", default="127.0.0.1", help="Address to listen on. [127.0.0.1]")
@click.option("--to", "remote", metavar="HOST:PORT", help="Send UDP there instead of listening.")
@click.option("--param", "parameters", multiple=True, metavar="NAME=VALUE", help="Repeatable.")
@click.option("--fault", "faults", multiple=True, metavar="LINE", help="Repeatable; see the docs.")
@click.option("--control", type=int, metavar="PORT", help="UDP port that takes fault lines.")
@click.option("--gps-noise", type=float, default=0.0, metavar="M", help="Standard deviation. [0]")
@click.option("--seed", type=click.IntRange(0), default=0, metavar="N", help="Of all randomness.")
def command(vehicles: int, speedup: float, seed: int, **choices: Any) -> int:
    """Simulate ArduCopter vehicles until Ctrl-C.

    Vehicle k listens on TCP 5760 + 10 (k - 1), its first port, and on UDP 14560 + 10 (k - 1).

    \b
    Example:  jfto sim --vehicles 3 --speedup 5 --fault "link 1 loss=0.1"
    """
    import time

    from jfto_sim.config import fleet
    from jfto_sim.server import ServerSettings, SimServer, default_endpoints

    configs = fleet(
        vehicles,
        _home(choices["home"]),
        spacing_m=choices["spacing"],
        seed=seed,
        parameters=_parameters(choices["parameters"]),
        gps_noise_m=choices["gps_noise"],
        utc_at_boot_us=int(time.time() * 1e6),
    )
    endpoints = default_endpoints(vehicles, choices["host"])
    if choices["remote"] is not None:
        endpoints = tuple((tcp, f"udpto:{choices['remote']}") for tcp, _ in endpoints)
    faults, control = choices["faults"], choices["control"]
    server = SimServer(configs, ServerSettings(endpoints, speedup, seed, faults, control))
    for sysid, texts in zip(server.stations, endpoints, strict=True):
        click.echo(f"vehicle {sysid}   {'   '.join(texts)}")
    if server.control_address is not None:
        host, port = server.control_address
        click.echo(f"faults      udp:{host}:{port}")
    try:
        server.run()
    except KeyboardInterrupt:
        click.echo("Stopped.")
    return 0
