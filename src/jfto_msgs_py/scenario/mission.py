"""What the fleet must keep to, and how hard to look for it."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.records.fields import param
from jfto_msgs_py.records.topology import ELASTIC, TOPOLOGY_FORMS


@dataclass(frozen=True)
class NetworkPart:
    """Rules for the number of neighbours."""

    k_min: int = param(
        2,
        "Least number of neighbours of every UAV, K_min. 0: none, the fleet need only be "
        "connected; a fleet of one has no other.",
        low=0,
        high=100,
    )
    delta: int = param(2, "Most neighbours beyond K_min, δ.", low=0, high=100)
    topology: str = param(
        ELASTIC,
        "Form of C-TOP. elastic: per slot K_min to K_min + δ neighbours, those that carry most; "
        "literal: Algorithm 2, as few as there must be; closed: the same, powers up to the next "
        "candidate's own, who may then be heard too.",
        choices=TOPOLOGY_FORMS,
    )
    ground_stations_deg: tuple[float, ...] = param(
        (),
        "Places of ground stations, latitude and longitude in turn. For each algorithm the rate is "
        "told that all UAVs can send to them at once, over several hops; a station is nobody's "
        "neighbour.",
        unit="deg",
        low=-180.0,
        high=180.0,
        later=True,
    )
    ground_antenna_m: float = param(
        2.0, "Height of their antennas above ground.", unit="m", low=0.0, high=200.0, later=True
    )
    ground_p_max_dbm: float = param(
        30.0, "Power of their radios.", unit="dBm", low=-30.0, high=60.0, later=True
    )


@dataclass(frozen=True)
class MissionPart:
    """Limits of the whole mission and its division into slots."""

    d_min_m: float = param(
        10.0, "Least distance between two UAVs, d_min.", unit="m", low=0.0, high=1000.0
    )
    length_max_m: float = param(
        40_000.0, "Greatest length of all routes together, L_max.", unit="m", low=1.0, high=1e7
    )
    slot_count: int = param(150, "Number of time slots, N.", low=1, high=10_000)
    horizon_s: float = param(
        0.0,
        "Duration T that the slots divide. 0: until the last UAV has reached its last waypoint.",
        unit="s",
        low=0.0,
        high=100_000.0,
    )


METHODS = ("search", "rl", "rl+search", "auto")


@dataclass(frozen=True)
class SearchPart:
    """Effort of the route search."""

    seed: int = param(0, "Seed of the search (also --seed).", low=0, high=2**31 - 1, hashed=False)
    method: str = param(
        "search",
        "How routes are found (also --method): by the search, by the trained policy, by the search "
        "from the policy's routes, or what has measured best (docs/explanation/policy.md).",
        choices=METHODS,
    )
    moves: int = param(
        8_000_000, "Moves tried in all; a budget that is equal on any machine.", low=1, high=10**12
    )
    starts: int = param(
        4, "Independent starts that share the moves; the best is kept.", low=1, high=1000
    )
    time_limit_s: float = param(
        0.0,
        "Ends the search early; 0: never. With a limit the same seed may give another plan.",
        unit="s",
        low=0.0,
        high=100_000.0,
    )
    workers: int = param(
        0, "Processor cores used; 0: all. Does not change the plan.", low=0, high=1024, hashed=False
    )


PAPER_SCENES = ("none", "small", "wanglang", "wanglang_gaussian", "wanghai")


@dataclass(frozen=True)
class EvaluationPart:
    """How the four topology algorithms are compared."""

    n_dc: int = param(
        45, "Slot at which one UAV is lost for ξ, n_DC.", low=0, high=10_000, hashed=False
    )
    slot_shown: int = param(45, "Slot whose topology is drawn.", low=0, high=10_000, hashed=False)
    paper_scene: str = param(
        "none",
        "Scene of the paper whose figures are printed beside ours.",
        choices=PAPER_SCENES,
        hashed=False,
    )
