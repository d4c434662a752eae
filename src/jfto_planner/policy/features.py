"""What a choice is described by: names, scales and bounds of the features.

The environment exists twice, compiled for CPUs and in tensors for training on any device; both take
from here what a feature is, so that they cannot differ in it.
"""

from __future__ import annotations

# Where, within the time that a choice decides for the whole fleet, the neighbour rule is checked.
CHECKED_FRACTIONS = (0.5, 1.0)

# Columns of the state, T and K of the active UAV and of the fleet.
STATE = (
    "time_used",  # share of T_a,max
    "time_left",
    "window",  # until the next UAV is free, 0 where no other flies
    "left",  # share of the waypoints
    "flying",  # share of the UAVs
    "work",  # length of a tour through what is left over the fleet's time, at most WORK_MOST
    "own_degree",  # over K_min, at most DEGREE_MOST
    "least_degree",  # of the fleet, likewise
    "alone",  # whether no other flies
    "nearest",  # log distance to the nearest waypoint
    "lead",  # greatest lead over the nearest rival at any waypoint
    "own_ground",  # share of the waypoints that this UAV is nearest to
)
# Columns of what relates the active UAV to a waypoint. Logarithms are log(1 + distance), distances
# in mean spacings of the waypoints.
PAIR = (
    "log_away",
    "log_rival",  # of the nearest other UAV in flight to the waypoint
    "away",  # over AWAY_SCALE
    "slack",  # share of T_a,max that would be left on arrival
    "log_next",  # from the waypoint to its nearest unvisited other
    "log_second",  # to its second nearest
    "log_excess",  # of the distance over that to the nearest waypoint
    "sooner",  # how much sooner than the first rival, over AWAY_SCALE
    "turn",  # cosine between the last leg and this one, 0 before the first
    "close",  # how many unvisited others are close, over CLOSE_SCALE
    "log_excess_next",  # of the distance with the next leg over the least such
)
STATE_FEATURES, PAIR_FEATURES = len(STATE), len(PAIR)
(TIME_USED, TIME_LEFT, WINDOW, LEFT, FLYING, WORK, OWN_DEGREE, LEAST_DEGREE, ALONE, NEAREST, LEAD,
 OWN_GROUND) = range(STATE_FEATURES)  # fmt: skip
(LOG_AWAY, LOG_RIVAL, AWAY, SLACK, LOG_NEXT, LOG_SECOND, LOG_EXCESS, SOONER, TURN, NEAR_OTHERS,
 LOG_EXCESS_NEXT) = range(PAIR_FEATURES)  # fmt: skip

# Length of a short tour through n points of a unit square over √n (Beardwood et al.).
TOUR = 0.7124
# Distance in extents that stands for "there is none".
NO_RIVAL = 2.0
# What counts as close to a waypoint, in mean spacings.
CLOSE = 1.5
# Divisors and bounds of features.
AWAY_SCALE, CLOSE_SCALE = 4, 8
WORK_MOST, DEGREE_MOST, LEAD_MOST, SOONER_MOST = 3.0, 4.0, 8.0, 2.0
# A degree that nobody has, and what a time and a length are at least where they divide.
NO_DEGREE = 10**6
LEAST_TIME, LEAST_LENGTH = 1e-3, 1e-9

# What every node knows of the whole problem.
GLOBAL = ("uavs", "waypoints", "mean_reach", "least_reach", "mean_time", "time_per_tour", "k_min",
          "climb")  # fmt: skip
GLOBAL_FEATURES = len(GLOBAL)
UAVS_SCALE, WAYPOINTS_SCALE, TIME_SCALE = 10, 100, 4
