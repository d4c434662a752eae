"""What the two forms of the environment, tensors and compiled loops, have in common."""

from __future__ import annotations

# Where, within the time that a choice decides for the whole fleet, the neighbour rule is checked.
CHECKED_FRACTIONS = (0.5, 1.0)
# T and K of the active UAV and of the fleet: share of T_a,max used, time left, time until the next
# UAV is free, shares of waypoints left and UAVs flying, work left over time left, degree of the
# active UAV and the least of all over K_min, whether nobody else flies; then the distance to the
# nearest waypoint, the greatest lead over rivals, and the share of waypoints nearest to this UAV.
STATE_FEATURES = 12
# What relates the active UAV to a waypoint: distance (twice, differently scaled) and in excess of
# the nearest one's; the nearest rival's distance and how much sooner it could be there; slack
# before T_a,max; the waypoint's nearest and second nearest unvisited others and how many are close;
# the turn; and the distance with the next leg after it, in excess of the least.
PAIR_FEATURES = 11
# Distance in extents that stands for "there is none".
NO_RIVAL = 2.0
# What counts as close to a waypoint, in mean spacings.
CLOSE = 1.5
