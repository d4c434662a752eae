"""The parameters of topology_node besides the scenario's."""

from __future__ import annotations

from dataclasses import dataclass

from jfto_msgs_py.records.fields import param


@dataclass(frozen=True)
class TopologyOptions:
    """The topology node's own parameters."""

    autostart: bool = param(True, "Configure and activate at start.")
    horizon_slots: int = param(
        0, "Slots solved ahead, the current one included; 0: all that are left.", low=0, high=10_000
    )
    stale_after_s: float = param(
        3.0, "Age of a pose that takes its UAV out.", unit="s", low=0.01, high=3600.0
    )
    pose_wait_s: float = param(
        0.2, "How long after a slot's beginning poses are waited for.", unit="s", low=0.0, high=60.0
    )
    margin_db: float = param(
        0.5,
        "Margin that links keep through their whole slot, besides two standard deviations of what "
        "they are measured to lose.",
        unit="dB",
        low=0.0,
        high=30.0,
    )
    learn_loss: bool = param(
        True, "Reckon with the loss that radios measure (/jfto/air/gain) beyond the channel's."
    )
    markers: bool = param(True, "Publish markers for RViz and Foxglove.")
    watch_slots: int = param(
        20, "Slots ahead in which breaches of the certificate are looked for.", low=1, high=10_000
    )
    terrain_cell_m: float = param(
        0.0,
        "Publish the ground as a mesh of cells of this size for RViz and Foxglove; 0: do not.",
        unit="m",
        low=0.0,
        high=10_000.0,
    )
