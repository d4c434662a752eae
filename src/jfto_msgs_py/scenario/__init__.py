"""The scenario: what a run depends on, with units, ranges and checks."""

from jfto_msgs_py.records.fields import Key
from jfto_msgs_py.scenario.scenario import KEYS, PARTS, Scenario
from jfto_msgs_py.scenario.validate import make_scenario
from jfto_msgs_py.scenario.value import Given

__all__ = ["KEYS", "PARTS", "Given", "Key", "Scenario", "make_scenario"]
