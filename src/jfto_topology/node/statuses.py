"""What the topology node says about the fleet and each UAV."""

from __future__ import annotations

from jfto_msgs_py.ros.diagnostics import ERROR, OK, STALE, WARN, Status
from jfto_msgs_py.types import Array
from jfto_topology.core import TopologyCore

Facts = dict[str, str]


def about_fleet(core: TopologyCore, facts: Facts) -> Status:
    """How the fleet as a whole is linked, and how late it runs; `facts` is what else to say."""
    last, missing = core.solved, core.missing
    if missing:
        return Status("", WARN, f"waiting for trajectories of {', '.join(missing)}", facts)
    if last is None:
        few = "fewer than two UAVs have a" if len(core.uav_ids) > 1 else "the UAV has no"
        return Status("", WARN, f"{few} fresh pose", facts)
    first = last.adjacency.horizon.first
    facts = facts | {"last_slot": str(first), "slot_shift_s": f"{last.shift_s:.2f}"}
    if last.lag_s is not None:
        facts["fleet_lag_s"] = f"{last.lag_s:.2f}"
    facts |= {f"ahead: {kind} {uavs}".rstrip(): text for (kind, uavs), text in core.dangers.items()}
    if last.blind:
        return Status("", ERROR, f"slot {first}, from last good predictions alone", facts)
    if last.topology.deficit[0].any() or not last.topology.connected[0]:
        return Status("", ERROR, f"slot {first}, not as connected as wanted", facts)
    if core.dangers:
        return Status("", WARN, f"slot {first}, trouble ahead", facts)
    return Status("", OK, f"slot {first}", facts)


def about_uav(
    core: TopologyCore, uav: str, margins_db: Array | None, facts: Facts, now_ns: int
) -> Status:
    """How one UAV is measured, and linked: `margins_db` (A, A) is that of the UAVs solved for."""
    last, prediction = core.solved, core.prediction
    stamp_ns = prediction.pose_stamp_ns(uav)
    if stamp_ns is None:
        return Status(uav, STALE, "no pose yet", facts)
    age_s = (now_ns - stamp_ns) / 1e9
    facts = facts | {"pose_age_s": f"{age_s:.2f}", "lag_s": f"{prediction.lag_s(uav):.2f}"}
    if age_s > core.settings.options.stale_after_s:
        blind = last is not None and last.blind and uav in last.adjacency.uav_ids
        how = "predicted from what was known" if blind else "excluded"
        return Status(uav, STALE, f"{how}: last pose is {age_s:.1f} s old", facts)
    if last is None or margins_db is None or uav not in last.adjacency.uav_ids:
        return Status(uav, WARN, "not part of a topology yet", facts)
    index = last.adjacency.uav_ids.index(uav)
    linked = last.adjacency.links[0, index]
    facts["last_slot"] = str(last.adjacency.horizon.first)
    facts["neighbours"] = str(int(linked.sum()))
    if linked.any():
        facts["margin_db"] = f"{margins_db[index][linked].min():.2f}"
    level, text = OK, f"{int(linked.sum())} neighbours"
    if last.topology.deficit[0, index]:
        level, text = ERROR, f"has fewer than {last.k_min} neighbours"
    elif prediction.is_off_route(uav):
        level, text = WARN, "off its route, reckoned with where it is measured"
    elif uav in last.late:
        level, text = WARN, "predicted from a late pose"
    return Status(uav, level, text, facts)
