"""A plan: who flies where and when, as a record that crosses borders and is written to disk."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from jfto_msgs_py.records.battery import Battery
from jfto_msgs_py.records.certificate import Certificate
from jfto_msgs_py.records.fields import MAY_LACK, OneOf, Range
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.records.site import Fence, GroundStation, Polygon, Sortie
from jfto_msgs_py.records.topology import LITERAL, TOPOLOGY_FORMS
from jfto_msgs_py.records.way_home import WayHome

Vector = tuple[float, float, float]

PLAN_FORMAT = "jfto-plan"
PLAN_VERSION = 3
# Plans of version 1 say nothing of the way home, of endurance and of wind; those of version 2
# nothing of area, fence, sortie and the form of C-TOP.
PLAN_VERSIONS_READ = (1, 2, 3)


@dataclass(frozen=True)
class Origin:
    """Where the local ENU frame sits: WGS-84 degrees, and metres above sea level.

    `datum` says in words which sea level that is, "" where nobody said.
    """

    lat_deg: float
    lon_deg: float
    alt_m: float
    datum: str = ""


@dataclass(frozen=True)
class Waypoint:
    """A camera position in ENU metres and where the camera looks.

    `yaw_deg` is clockwise from north, `pitch_deg` is 0 at the horizon and -90 straight down.
    Without `photo` it is a place that a route only passes, round a no-fly zone.
    """

    id: Annotated[int, Range(0)]
    position_m: Vector
    yaw_deg: float = 0.0
    pitch_deg: Annotated[float, Range(-90, 90)] = -90.0
    photo: bool = field(default=True, metadata=MAY_LACK)


@dataclass(frozen=True)
class Uav:
    """One vehicle of the fleet: its limits and its pad (ENU metres).

    `endurance_s` is how long its battery lets it fly from lift-off to landing, 0 where nobody said;
    `battery` says what there is to fly with, None where nobody knows.
    """

    id: str
    p_max_dbm: float
    energy_j: float
    t_max_s: float
    speed_mps: float
    climb_mps: float
    descent_mps: float
    start_m: Vector
    endurance_s: float = 0.0
    battery: Battery | None = None


@dataclass(frozen=True)
class Line:
    """A straight part of a route along which the camera is triggered by distance or by time.

    `first` and `last` are indices along the route; the vehicle is not told of those in between.
    """

    first: Annotated[int, Range(0)]
    last: Annotated[int, Range(0)]


@dataclass(frozen=True)
class Route:
    """What one UAV flies: waypoint ids in order, arrival times (s from lift-off), length in m.

    `arrival_s` has one entry per waypoint of `waypoint_ids`; the pad, left at 0 s, is not listed.
    """

    waypoint_ids: tuple[int, ...]
    arrival_s: tuple[float, ...]
    length_m: float
    lines: tuple[Line, ...] = ()

    @property
    def end_s(self) -> float:
        """When the last waypoint is reached, 0 where there is none."""
        return max(self.arrival_s, default=0.0)


@dataclass(frozen=True)
class Slots:
    """Division of the mission into `count` slots of `duration_s`; instants are n = 0 … count."""

    count: Annotated[int, Range(1)]
    duration_s: Annotated[float, Range(0.0, above=True)]

    @property
    def horizon_s(self) -> float:
        """T, the end of the last slot."""
        return self.count * self.duration_s

    @property
    def times_s(self) -> NDArray[np.float64]:
        """The count + 1 instants t_n in seconds."""
        return np.arange(self.count + 1, dtype=np.float64) * self.duration_s


@dataclass(frozen=True)
class Plan:
    """The whole plan. `routes[a]` belongs to `uavs[a]`; `positions_m` is (A, count + 1, 3), ENU.

    `time_model` and `time_parameters` say how routes turn into times; under "bezier" the flight is
    `trajectories`, one record per UAV, which is empty otherwise. `homes` are the ways home, one per
    UAV, empty where none is planned. `wind_mps` is the wind that speeds leave room for below the
    tilt limit; times are for calm air. `topology` is the form of C-TOP in flight. `area` is what is
    to be seen, empty where it is the whole rectangle of the terrain or nobody said. `trigger` is
    how photographs on `lines` of the routes are taken (distance, time; each: there are none),
    `mission_items` what an autopilot holds. `certificate` is None before the check.
    """

    scenario_hash: str
    seed: int
    origin: Origin
    radio: Radio
    k_min: int
    delta: int
    d_min_m: float
    length_max_m: float
    slots: Slots
    waypoints: tuple[Waypoint, ...]
    uavs: tuple[Uav, ...]
    routes: tuple[Route, ...]
    positions_m: NDArray[np.float64]
    certificate: Certificate | None = None
    time_model: str = "constant_speed"
    time_parameters: Mapping[str, float] = field(default_factory=dict)
    trajectories: tuple[dict[str, Any], ...] = field(default=())
    homes: tuple[WayHome, ...] = ()
    wind_mps: float = 0.0
    topology: Annotated[str, OneOf(TOPOLOGY_FORMS)] = LITERAL
    area: tuple[Polygon, ...] = ()
    fence: Fence | None = None
    ground_stations: tuple[GroundStation, ...] = ()
    sortie: Sortie = field(default_factory=Sortie)
    trigger: str = "each"
    mission_items: int = 650

    @property
    def total_length_m(self) -> float:
        """Summed length of all routes in metres (P1obj)."""
        return float(sum(route.length_m for route in self.routes))

    @property
    def photo_count(self) -> int:
        """How many waypoints are to be visited; the others are only passed."""
        return sum(waypoint.photo for waypoint in self.waypoints)

    @property
    def landed_s(self) -> float | None:
        """When the last UAV stands at its pad, s from lift-off; None without planned ways home."""
        return max((home.landed_s for home in self.homes), default=None)

    @property
    def clean(self) -> bool:
        """Whether the plan has been checked and nothing was found."""
        return self.certificate is not None and self.certificate.clean

    def line_m(self, uav: int) -> NDArray[np.float64]:
        """Pad and waypoints of the UAV with this index, in its route's order: (K + 1, 3), ENU."""
        where = {waypoint.id: waypoint.position_m for waypoint in self.waypoints}
        stops = [where[number] for number in self.routes[uav].waypoint_ids]
        return np.array([self.uavs[uav].start_m, *stops])
