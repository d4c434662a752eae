"""The parameters of pose_player besides the scenario's."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.scenario.key import param


@dataclass(frozen=True)
class PosePlayerOptions:
    """The pose player's own parameters."""

    autostart: bool = param(True, "Configure and activate at start.")
    rate_hz: float = param(10.0, "Poses per second and UAV.", unit="Hz", low=0.1, high=1000.0)
