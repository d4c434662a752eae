"""The parameters of power_node besides the scenario's."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.scenario.key import param


@dataclass(frozen=True)
class PowerOptions:
    """The power node's own parameters."""

    autostart: bool = param(True, "Configure and activate at start.")
    uav_id: str = param("", "Publish for this UAV only; left out: for the whole fleet.")
    energy_reserve: float = param(
        0.05,
        "Share of the energy left that is only spent on least powers, for a future that turns out "
        "dearer than predicted.",
        low=0.0,
        high=1.0,
    )
    state_file: str = param(
        "", "File that keeps the energy account over a restart; left out: none."
    )
