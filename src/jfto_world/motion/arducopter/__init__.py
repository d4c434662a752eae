"""ArduCopter's waypoint missions in time: planner in closed form, vehicle in closed loop.

`plan_target` gives the planner's target along a route, `fly_route` the vehicle behind it, and
`ArduCopter` is the `TimeModel` built on both. See docs/explanation/trajectories.md.
"""

from jfto_world.motion.arducopter.closed_loop import Flight, fly_route
from jfto_world.motion.arducopter.target import TargetTrack, plan_target
from jfto_world.motion.arducopter.time_model import ArduCopter
from jfto_world.motion.arducopter.wpnav import Airframe, WpNav

__all__ = [
    "Airframe",
    "ArduCopter",
    "Flight",
    "TargetTrack",
    "WpNav",
    "fly_route",
    "plan_target",
]
