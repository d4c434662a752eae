"""The parameters of power_node and radio_node besides the scenario's."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.fields import param

DRIVERS = ("log", "sim", "iw")


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


@dataclass(frozen=True)
class RadioOptions:
    """The radio node's own parameters."""

    autostart: bool = param(True, "Configure and activate at start.")
    uav_id: str = param(
        "", "Set this UAV's radio only, as on its companion; left out: those of the whole fleet."
    )
    driver: str = param(
        "log",
        "log: only write what would be set; sim: simulated radios; iw: the radio of this computer.",
        choices=DRIVERS,
    )
    log_file: str = param("", "log: file that lines are added to; left out: the node's own log.")
    control: str = param("127.0.0.1:14500", "sim: the simulator's control socket, host:port.")
    interface: str = param("wlan0", "iw: the radio's network interface.")
    iw_command: str = param("iw", "iw: the tool, with arguments of its own if need be.")
    power_step_db: float = param(
        1.0,
        "iw: steps that the radio can do; powers are rounded up.",
        unit="dB",
        low=0.01,
        high=10.0,
    )
    least_dbm: float = param(
        0.0, "iw: least power, also taken for silence.", unit="dBm", low=0.0, high=30.0
    )
    interval_s: float = param(
        0.5, "iw: least time between two settings of the radio.", unit="s", low=0.0, high=60.0
    )
    tolerance_db: float = param(
        1.0,
        "How far what is read back may be from the setpoint.",
        unit="dB",
        low=0.0,
        high=20.0,
    )


def served_ids(uav_id: str, fleet_ids: tuple[str, ...]) -> tuple[str, ...]:
    """The UAV that `uav_id` names, or the whole fleet where it is empty.

    Raises InputError where there is no such UAV.
    """
    if uav_id and uav_id not in fleet_ids:
        raise InputError(f"uav_id is {uav_id!r}, must be one of {', '.join(fleet_ids)}.")
    return (uav_id,) if uav_id else fleet_ids
