"""The plan's constraints on the tracks that were flown."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jfto.analysis.grid import FINER, FlownGrid
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.types import Array, Flags
from jfto_planner.routing.certificate import Instants, plan_instants

# Near its pad a UAV takes off and lands.
PAD_M = 15.0


@dataclass(frozen=True)
class FlownException:
    """One spell in which a constraint was broken.

    `kind` is one of those of a plan's certificate, or "height" (over the terrain), "seen" (no
    pose for a while) or "lost" (no pose any more). `uav` is "uav1+uav2" for a pair and "" for the
    fleet; the spell is from `first_slot` to `last_slot`, fractional where it began or ended
    between instants. `value` is the worst in it, in the unit of `limit`; `margin_db` what the
    link to the K_min-th neighbour had to spare, for neighbours only. `cause` is in words, empty
    where none is known.
    """

    kind: str
    uav: str
    first_slot: float
    last_slot: float
    time_s: float
    value: float
    limit: float
    margin_db: float | None
    message: str
    cause: str = ""


@dataclass(frozen=True, eq=False)
class FlownCertificate:
    """Findings on a grid of instants.

    `clean` (slots + 1,) says per slot that no constraint was broken at any of its instants.
    `slot_checks` and `slot_violations` count the neighbour rule at slots' instants as a plan's
    certificate does. `margin_db` (T,) is the least margin of all UAVs, `separation_m` (T,) the
    least distance, inf where nobody is; `height_m` (T, A) over the terrain, nan where unknown.
    """

    clean: Flags
    slot_checks: int
    slot_violations: int
    worst_margin_db: float
    worst_margin_uav: str
    worst_margin_slot: float
    margin_db: Array
    separation_m: Array
    height_m: Array
    exceptions: tuple[FlownException, ...]

    @property
    def clean_share(self) -> float:
        """Share of slots without any violation."""
        return float(self.clean.mean())

    @property
    def least_separation_m(self) -> float:
        """Least distance between two UAVs in the whole mission."""
        return float(self.separation_m.min(initial=np.inf))

    @property
    def least_height_m(self) -> float | None:
        """Least height over the terrain, pads included; None where it is never known."""
        known = self.height_m[np.isfinite(self.height_m)]
        return float(known.min()) if known.size else None


def flown_certificate(
    plan: Plan, grid: FlownGrid, height_m: Array, clearance_m: float
) -> FlownCertificate:
    """Check K_min at P_max, connectivity, d_min and height on the flown tracks.

    `height_m` (T, A) is over the terrain; away from the pads it must be `clearance_m`. Energy is
    checked where it is known, see `energy`.
    """
    instants = plan_instants(plan, grid.position_m, FINER, grid.present)
    low = _too_low(plan, grid, height_m, clearance_m)
    faults = {
        "neighbours": instants.short,
        "connected": (instants.components > 1)[:, None],
        "separation": instants.close,
        "height": low,
        "seen": grid.present & ~grid.seen,
        "lost": ~grid.present,
    }
    broken = np.zeros(len(grid.times_s), dtype=np.bool_)
    findings = _Findings(plan, grid, instants, height_m)
    exceptions: list[FlownException] = []
    for kind, flags in faults.items():
        broken |= flags.any(axis=1)
        for who in np.flatnonzero(flags.any(axis=0)):
            for begin, end in spells(flags[:, who]):
                exceptions.append(findings.exception(kind, int(who), begin, end))
    checks = instants.short[::FINER]
    margin_db, uav, slot = instants.worst_margin()
    return FlownCertificate(
        clean=~np.logical_or.reduceat(broken, np.arange(0, len(broken), FINER)),
        slot_checks=int(grid.present[::FINER].sum()),
        slot_violations=int(checks.sum()),
        worst_margin_db=margin_db,
        worst_margin_uav=plan.uavs[uav].id,
        worst_margin_slot=slot,
        margin_db=instants.margin_db.min(axis=1),
        separation_m=instants.distance.min(axis=1, initial=np.inf),
        height_m=height_m,
        exceptions=tuple(sorted(exceptions, key=lambda one: (one.first_slot, one.kind, one.uav))),
    )


def spells(flags: Flags) -> list[tuple[int, int]]:
    """First and last row of each run of True in (T,)."""
    edge = np.diff(np.concatenate([[0], flags.astype(np.int8), [0]]))
    begins, ends = np.flatnonzero(edge == 1), np.flatnonzero(edge == -1) - 1
    return [(int(a), int(b)) for a, b in zip(begins, ends, strict=True)]


def _too_low(plan: Plan, grid: FlownGrid, height_m: Array, clearance_m: float) -> Flags:
    pads = np.array([uav.start_m for uav in plan.uavs])
    from_pad = np.linalg.norm((grid.position_m - pads)[..., :2], axis=2)
    with np.errstate(invalid="ignore"):
        return grid.present & (from_pad > PAD_M) & (height_m < clearance_m)


@dataclass(frozen=True, eq=False)
class _Findings:
    """Puts spells of faults into words, each with the worst that happened in it."""

    plan: Plan
    grid: FlownGrid
    instants: Instants
    height_m: Array

    def exception(self, kind: str, who: int, begin: int, end: int) -> FlownException:
        """One spell, from row `begin` to row `end`, of the UAV or pair with index `who`."""
        plan, instants, rows = self.plan, self.instants, slice(begin, end + 1)
        first, last = begin / FINER, end / FINER
        when = f"slot {first:g}" if begin == end else f"slots {first:g} to {last:g}"
        uav = plan.uavs[who].id if kind not in {"connected", "separation"} else ""
        begin_s = float(self.grid.times_s[begin])
        limit, margin = 0.0, None
        if kind == "neighbours":
            value, limit = float(instants.degree[rows, who].min()), float(plan.k_min)
            margin = float(instants.margin_db[rows, who].min())
            word = "neighbour" if value == 1 else "neighbours"
            message = f"{uav} had {value:.0f} {word} at P_max in {when}, K_min is {plan.k_min}"
        elif kind == "connected":
            value, limit = float(instants.components[rows].max()), 1.0
            message = f"the fleet was in {value:.0f} parts in {when}"
        elif kind == "separation":
            a, b = instants.pairs[0][who], instants.pairs[1][who]
            uav = f"{plan.uavs[a].id}+{plan.uavs[b].id}"
            value, limit = float(instants.distance[rows, who].min()), plan.d_min_m
            message = f"{uav} were {value:.2f} m apart in {when}, d_min is {plan.d_min_m:g} m"
        elif kind == "height":
            value = float(np.nanmin(self.height_m[rows, who]))
            message = f"{uav} was {value:.1f} m over the terrain in {when}"
        else:
            value = float(self.grid.times_s[end]) - begin_s
            word = "was not heard" if kind == "seen" else "was not there"
            message = f"{uav} {word} for {value:.1f} s in {when}"
        return FlownException(kind, uav, first, last, begin_s, value, limit, margin, message)
