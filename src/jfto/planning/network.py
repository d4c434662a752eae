"""The network of a plan: the arrays that topology and power work on, and both of them solved."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.records.site import GroundStation
from jfto_msgs_py.scenario.mission import NetworkPart
from jfto_msgs_py.types import Array
from jfto_msgs_py.units import dbm_to_w
from jfto_power.allocation import Allocation, PowerProblem, allocate, allocate_prefix
from jfto_power.shortage import EnergyShortage
from jfto_topology.algorithms.ctop import Topology, energy_floor
from jfto_topology.algorithms.elastic import Air, topology_of_form
from jfto_world.radio import LogDistanceChannel, make_channel, noise_w, pairwise_distances
from jfto_world.terrain import Dem

EnergyFloor = Callable[[Array, float], Array]


@dataclass(frozen=True)
class Network:
    """Channel, limits and link gains of a plan; slots n = 0 … N on axis 0, UAVs on axis 1.

    `positions_m` is (N + 1, A, 3), `gain` (N + 1, A, A) linear, `p_max_w`, `energy_j` and
    `speed_mps` (A,).
    """

    channel: LogDistanceChannel
    positions_m: Array
    gain: Array
    p_max_w: Array
    sensitivity_w: float
    energy_j: Array
    speed_mps: Array


def network_of(plan: Plan) -> Network:
    """Arrays of a plan."""
    channel = make_channel(plan.radio)
    positions = np.ascontiguousarray(np.moveaxis(plan.positions_m, 0, 1))
    return Network(
        channel=channel,
        positions_m=positions,
        gain=channel.gain(pairwise_distances(positions)),
        p_max_w=dbm_to_w(np.array([uav.p_max_dbm for uav in plan.uavs])),
        sensitivity_w=float(dbm_to_w(plan.radio.sensitivity_dbm)),
        energy_j=np.array([uav.energy_j for uav in plan.uavs]),
        speed_mps=np.array([uav.speed_mps for uav in plan.uavs]),
    )


def ground_stations(network: NetworkPart, dem: Dem) -> tuple[GroundStation, ...]:
    """Ground stations on the ground of a DEM; raises InputError for one beside it."""
    stations = []
    places = network.ground_stations_deg
    for latitude, longitude in zip(places[::2], places[1::2], strict=True):
        east, north, _ = dem.to_enu(latitude, longitude, dem.origin.alt_m)
        if not dem.contains(east, north):
            raise InputError(
                f"network.ground_stations_deg: {latitude:.6f}, {longitude:.6f} lies outside the "
                "terrain, so the height of its ground is not known. Move it, or widen "
                "terrain.size_m."
            )
        up = float(dem.height(east, north)) + network.ground_antenna_m
        place = (float(east), float(north), up)
        stations.append(GroundStation(place, network.ground_p_max_dbm))
    return tuple(stations)


def topology_of(plan: Plan, network: Network, form: str | None = None) -> Topology:
    """Neighbours and power intervals of every slot by a form of C-TOP, the plan's where None.

    Raises InputError.
    """
    air = Air(network.gain, network.p_max_w, network.sensitivity_w, noise_w(plan.radio))
    # Energy is spent from slot 1 on.
    duration_s = np.full(plan.slots.count + 1, plan.slots.duration_s)
    duration_s[0] = 0.0
    return topology_of_form(
        form or plan.topology, air, plan.k_min, plan.delta, network.energy_j, duration_s
    )


def power_of(plan: Plan, network: Network, topology: Topology) -> tuple[Allocation, str]:
    """Best powers within the topology's intervals and the energy.

    Where the energy does not last they are those of the longest prefix of slots that it does for,
    and the second result says so; else it is empty.
    """
    problem = PowerProblem(
        topology.adjacency,
        network.gain,
        topology.p_min_w,
        topology.p_upper_w,
        network.energy_j,
        plan.slots.duration_s,
        plan.radio,
        tuple(uav.id for uav in plan.uavs),
    )
    try:
        return allocate(problem), ""
    except EnergyShortage as shortage:
        return allocate_prefix(problem), str(shortage)


def energy_floor_of(
    radio: Radio, p_max_dbm: tuple[float, ...], k_min: int, delta: int
) -> EnergyFloor:
    """C-TOP's least energy as a function of positions and slot length, for planner and check."""
    return partial(
        energy_floor,
        channel=make_channel(radio),
        p_max_w=dbm_to_w(np.array(p_max_dbm)),
        sensitivity_w=float(dbm_to_w(radio.sensitivity_dbm)),
        k_min=k_min,
        delta=delta,
    )
