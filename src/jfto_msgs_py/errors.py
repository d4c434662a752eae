"""Every error that JFTO raises on purpose.

JftoError
├── InputError            a file, key or argument is wrong (exit status 2)
│   ├── ScenarioError     scenario file or parameter
│   ├── TerrainError      elevation model
│   ├── SiteError         file of areas or no-fly zones
│   ├── WaypointError     waypoint file or set
│   └── PlanError         plan file
├── InfeasibleError       the wish cannot be met as stated (exit status 3)
└── MessageError          a ROS message that breaks its contract

A message names the object, the reason and what to do about it.
"""

from __future__ import annotations


class JftoError(Exception):
    """Base of all errors that JFTO raises on purpose; `exit_status` is the command line's."""

    exit_status = 1


class InputError(JftoError):
    """A file, key or argument is wrong."""

    exit_status = 2


class ScenarioError(InputError):
    """A scenario is wrong; `problems` lists every fault found, one sentence each."""

    def __init__(self, problems: str | list[str]) -> None:
        self.problems = [problems] if isinstance(problems, str) else list(problems)
        super().__init__("\n".join(self.problems))


class TerrainError(InputError):
    """An elevation model cannot be read, or does not hold what is asked of it."""


class SiteError(InputError):
    """Areas or no-fly zones cannot be read or used."""


class WaypointError(InputError):
    """A set of waypoints cannot be read or used."""


class PlanError(InputError):
    """A plan file cannot be read, or contradicts itself."""


class InfeasibleError(JftoError):
    """What is asked for cannot be met; `cures` lists what would make it possible."""

    exit_status = 3

    def __init__(self, message: str, cures: tuple[str, ...] = ()) -> None:
        super().__init__(message)
        self.cures = cures


class MessageError(JftoError):
    """A ROS message that breaks its contract; `field` names the part at fault."""

    def __init__(self, field: str, reason: str) -> None:
        super().__init__(f"{field}: {reason}")
        self.field = field
        self.reason = reason
