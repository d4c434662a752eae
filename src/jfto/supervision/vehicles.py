"""Which vehicles a graph flies, as parameters of the processes that speak with them."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from jfto.supervision.graph_table import WHO_FLIES, Parameters, Vehicles
from jfto_mavlink.errors import RosterError
from jfto_mavlink.fleet.roster import are_simulated, parse_vehicles
from jfto_mavlink.io.address import free_udp_port, parse_address

FROM_SCENARIO = "roster"


def choose_vehicles(
    texts: Sequence[str],
    uavs: Sequence[str],
    options: Mapping[str, object],
    *,
    speedup: float = 1.0,
    arm: bool = False,
    key_file: Path | None = None,
) -> Vehicles:
    """Vehicles as `--vehicles` names them.

    `texts` is one of: ("sim",) or ("sim:N",); links, one for all UAVs or one each, which then have
    the system ids 1, 2 …; roster entries UAV=SYSID@LINK[#UID]; ("roster",), which leaves it to
    `options`, the scenario's section mavlink_bridge. `arm` lets the start service arm real ones.
    Raises RosterError, LinkAddressError.
    """
    if are_simulated(texts):
        parse_vehicles(texts, uavs)
        if key_file is not None:
            raise RosterError(201, "simulated vehicles start without a key; leave --key out.")
        return _simulated(speedup)
    if speedup != 1.0:
        raise RosterError(201, "--speedup is for simulated vehicles (sim); real ones keep time.")
    named(texts, options)
    bridge: dict[str, Any]
    if tuple(texts) == (FROM_SCENARIO,):
        bridge = {key: options[key] for key in WHO_FLIES if key in options}
    elif any("=" in text for text in texts):
        bridge = {"roster": tuple(texts)}
    else:
        bridge = {"endpoints": tuple(str(parse_address(text)) for text in texts)}
    if key_file is not None:
        bridge["key_file"] = str(key_file)
    if arm:
        bridge["allow_arming"] = True
    parse_vehicles(bridge.get("roster", ()), uavs, bridge.get("endpoints", ()))
    return Vehicles(simulated=False, given={"mavlink_bridge": bridge}, suited=_AWAITED)


# A flight begins when the fleet does.
_AWAITED: Parameters = {"planner_node": {"await_lift_off": True}}


def named(
    texts: Sequence[str], options: Mapping[str, object]
) -> tuple[Sequence[str], Sequence[str]]:
    """Roster entries and endpoints of a command line, for `parse_vehicles`.

    ("roster",) stands for those of the scenario's section mavlink_bridge, `options`; raises
    RosterError where that names none.
    """
    if tuple(texts) != (FROM_SCENARIO,):
        return texts, ()
    roster, endpoints = options.get("roster", ()), options.get("endpoints", ())
    assert isinstance(roster, Sequence)
    assert isinstance(endpoints, Sequence)
    if not roster and not endpoints:
        raise RosterError(
            201, "the scenario's section mavlink_bridge names no roster and no endpoints."
        )
    return roster, endpoints


def _simulated(speedup: float) -> Vehicles:
    """A process of simulated vehicles and the bridge to it, on a port that is free now."""
    port, control = free_udp_port(), free_udp_port()
    return Vehicles(
        simulated=True,
        given={
            "simulated_fleet": {
                "endpoint": f"udpto:127.0.0.1:{port}",
                "speedup": float(speedup),
                "start_time_s": time.time(),
                "control_port": control,
            },
            "radio_node": {"driver": "sim", "control": f"127.0.0.1:{control}"},
            "mavlink_bridge": {
                "endpoints": (f"udpin:127.0.0.1:{port}",),
                "speedup": float(speedup),
                "vehicle_stamps": True,
                "allow_arming": True,
            },
        },
        suited={
            **_AWAITED,
            # What one core carries of the fleet that is sped up.
            "mavlink_bridge": {"telemetry_rate_hz": min(10.0, max(4.0, 20.0 / speedup))},
            # A quarter of a second until the next position, and what their time may be ahead of it.
            "topology_node": {"pose_wait_s": 1.0},
        },
    )
