"""How radio waves and bits travel between UAVs."""

from jfto_world.radio.channel import Channel, LogDistanceChannel, make_channel
from jfto_world.radio.link import degrees, mutual_links, noise_w, pairwise_distances, rate_bps
from jfto_world.radio.loss_estimate import LossEstimate

__all__ = [
    "Channel",
    "LogDistanceChannel",
    "LossEstimate",
    "degrees",
    "make_channel",
    "mutual_links",
    "noise_w",
    "pairwise_distances",
    "rate_bps",
]
