"""The way home of the whole fleet: over the ground, apart from one another, soon."""

from jfto_planner.home.plan_home import HomeRules, with_ways_home

__all__ = ["HomeRules", "with_ways_home"]
