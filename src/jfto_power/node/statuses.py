"""What the power node says about the fleet and each UAV."""

from __future__ import annotations

from collections.abc import Mapping

from jfto_msgs_py.ros.diagnostics import ERROR, OK, WARN, Status
from jfto_msgs_py.units import w_to_dbm
from jfto_power.core import PowerCore

Facts = dict[str, str]


def about_fleet(core: PowerCore, troubles: Mapping[str, str], facts: Facts, now_ns: int) -> Status:
    """Whether powers are solved, the energy lasts and the topology is heard of.

    `troubles` are texts by what they are about, "" where there is none; `facts` what else to say.
    """
    troubles = {about: text for about, text in troubles.items() if text}
    facts = facts | troubles
    if core.solved is None:
        return Status("", WARN, "waiting for a topology", facts)
    slot = core.slot_at(now_ns)
    facts["last_slot"] = str(slot)
    if core.solved.shortage is not None:
        return Status("", ERROR, str(core.solved.shortage), facts)
    silent_s, run_out = core.silence(now_ns)
    if silent_s:
        text = f"topology silent for {silent_s:.1f} s, going on through its last schedule"
        if run_out:
            text = f"topology silent for {silent_s:.1f} s, its last schedule has run out"
        return Status("", ERROR if run_out else WARN, text, facts)
    level = WARN if troubles else OK
    return Status("", level, " ".join([f"slot {slot}", *troubles.values()]), facts)


def about_uav(core: PowerCore, uav: str, facts: Facts) -> Status:
    """Energy left to a UAV's radio and its power in force, as of the account's last `advance`."""
    account, solved = core.account, core.solved
    left_j, budget_j = account.left_j[uav], account.budget_j[uav]
    facts = facts | {"energy_left_j": f"{left_j:.3f}", "energy_budget_j": f"{budget_j:.3f}"}
    facts["tx_power_dbm"] = f"{w_to_dbm(account.power_w[uav]):.2f}"
    if left_j <= 0:
        return Status(uav, ERROR, "no energy left", facts)
    if solved is not None and uav not in solved.schedule.uav_ids:
        return Status(uav, WARN, "not part of the schedule, keeps its power", facts)
    return Status(uav, OK, f"{100 * left_j / budget_j:.0f} % of the energy left", facts)
