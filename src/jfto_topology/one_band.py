"""What links carry if all of them share one channel, as radios of one band do.

The sum over links takes each to have the band for itself. In one channel those that send at once
disturb each other: a set of transmissions works if every receiver still has enough signal over
noise and interference.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.types import Array, Flags, Ints
from jfto_msgs_py.units import db_to_ratio
from jfto_world.radio import noise_w

# Signal over noise and interference that a transmission needs.
SINR_DB = 10.0


@dataclass(frozen=True)
class OneBand:
    """Best set of transmissions of each slot: their rates together (M,) in bit/s, their number."""

    throughput_bps: Array
    at_once: Ints


def one_band(
    linked: Flags, gain: Array, power_w: Array, radio: Radio, sinr_db: float = SINR_DB
) -> OneBand:
    """The transmissions over links of one slot that carry most when all send in one channel.

    Exact: a set that works works without any of its members too, so all sets are found from pairs
    that bear each other. A node sends to one or hears one at a time.

    Parameters
    ----------
    linked, gain
        Links and linear gains (M, A, A).
    power_w
        Powers (M, A) in W.
    radio
        Bandwidth and noise.
    sinr_db
        Signal over noise and interference that each receiver needs.

    Returns
    -------
    OneBand
        Slot by slot.

    Raises
    ------
    InputError
        Shapes do not fit together.
    """
    if gain.shape != linked.shape or power_w.shape != linked.shape[:2]:
        raise InputError(
            f"gain has shape {gain.shape} and power_w {power_w.shape}, must be {linked.shape} and "
            f"{linked.shape[:2]}."
        )
    least, noise = db_to_ratio(sinr_db), noise_w(radio)
    bits, count = np.zeros(len(linked)), np.zeros(len(linked), dtype=np.int64)
    for slot in range(len(linked)):
        received = power_w[slot][:, None] * gain[slot]
        sender, receiver = np.nonzero(linked[slot])
        best = _Search(received, sender, receiver, noise, least).best()
        bits[slot], count[slot] = best
    return OneBand(bits * radio.bandwidth_hz, count)


class _Search:
    """All working sets of one slot's transmissions, depth first.

    `received` (A, A) is what each sender's power is at each receiver, in W.
    """

    def __init__(
        self, received: Array, sender: Ints, receiver: Ints, noise: float, least: float
    ) -> None:
        self.signal = received[sender, receiver]
        # What transmission i does to the receiver of transmission j.
        self.harm = received[sender[:, None], receiver[None, :]]
        self.noise, self.least = noise, least
        self.alone = np.log2(1 + self.signal / noise)
        ends = np.stack([sender, receiver])
        apart = (ends[:, None, :, None] != ends[None, :, None, :]).all(axis=(0, 1))
        works = self.signal[None, :] >= least * (noise + self.harm)
        self.bear = apart & works & works.T

    def best(self) -> tuple[float, int]:
        """Bits per second and hertz of the best set, and how many send in it."""
        order = np.flatnonzero(self.signal >= self.least * self.noise)
        order = order[np.argsort(-self.alone[order], kind="stable")]
        self._bits, self._count = 0.0, 0
        self._extend([], order)
        return self._bits, self._count

    def _extend(self, chosen: list[int], left: Ints) -> None:
        """Try every larger set out of what bears all that is chosen."""
        for place, one in enumerate(left):
            bound = sum(self.alone[chosen]) + self.alone[left[place:]].sum()
            if bound <= self._bits:
                return
            members = [*chosen, int(one)]
            disturbed = self.harm[np.ix_(members, members)].sum(axis=0) - self.signal[members]
            ratio = self.signal[members] / (self.noise + disturbed)
            if (ratio < self.least).any():
                continue
            bits = float(np.log2(1 + ratio).sum())
            if bits > self._bits:
                self._bits, self._count = bits, len(members)
            later = left[place + 1 :]
            self._extend(members, later[self.bear[one, later]])
