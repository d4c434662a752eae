"""Features of a choice as tensors; kernel/describe.py is the compiled twin."""

from __future__ import annotations

import torch
from torch import Tensor

from jfto_planner.policy.features import (
    AWAY_SCALE,
    CLOSE,
    CLOSE_SCALE,
    DEGREE_MOST,
    LEAD_MOST,
    LEAST_LENGTH,
    LEAST_TIME,
    NO_DEGREE,
    NO_RIVAL,
    PAIR,
    SOONER_MOST,
    STATE,
    TOUR,
    WORK_MOST,
)
from jfto_planner.policy.network.rollout_state import RolloutState, row_of


def describe_state(
    state: RolloutState,
    active: Tensor,
    now: Tensor,
    others_free: Tensor,
    degree: Tensor,
    drawn: dict[str, Tensor],
) -> Tensor:
    """T and K of the active UAV and of the fleet, (B, P, STATE_FEATURES), with what is `drawn` from
    the waypoints.
    """
    batch = state.batch
    t_max = batch.t_max[:, None].expand_as(state.arrive)
    own_t_max = t_max.gather(-1, active[..., None]).squeeze(-1)
    left = (~state.visited).sum(-1).float()
    total = batch.waypoint_valid.sum(-1)[:, None].float()
    flying = (~state.done).sum(-1).float()
    uavs = batch.uav_valid.sum(-1)[:, None].float()
    capacity = torch.where(state.done, 0.0, (t_max - state.arrive).clamp(min=0)).sum(-1)
    need = batch.k_min[:, None].float().clamp(min=1)
    own_degree = degree.gather(-1, active[..., None]).squeeze(-1)
    least = torch.where(batch.uav_valid[:, None], degree, NO_DEGREE).amin(-1)
    window = torch.where(torch.isfinite(others_free), others_free - now, 0.0)
    work = TOUR * left / total.sqrt()
    columns = drawn | {
        "time_used": now / own_t_max,
        "time_left": own_t_max - now,
        "window": window,
        "left": left / total,
        "flying": flying / uavs,
        "work": (work / capacity.clamp(min=LEAST_TIME)).clamp(max=WORK_MOST),
        "own_degree": (own_degree / need).clamp(max=DEGREE_MOST),
        "least_degree": (least / need).clamp(max=DEGREE_MOST),
        "alone": (~torch.isfinite(others_free)).float(),
    }
    return torch.stack([columns[name] for name in STATE], dim=-1)


def describe_pairs(
    state: RolloutState, active: Tensor, now: Tensor, duration: Tensor, distance: Tensor
) -> tuple[Tensor, dict[str, Tensor]]:
    """What relates the active UAV to each waypoint, (B, P, W, PAIR_FEATURES), 0 where visited, and
    the features of the state that are drawn from it, each (B, P).
    """
    batch, free = state.batch, ~state.visited
    unit = batch.waypoint_valid.sum(-1)[:, None, None].float().sqrt()
    t_max = batch.t_max[:, None].expand_as(state.arrive).gather(-1, active[..., None])
    rival, soonest = _rivals(state, active, now)
    first, second, close = _others(batch.waypoints, free, unit)
    excess, drawn = _relative_to_nearest(free, distance, distance + first, rival, unit)
    sooner = (soonest - duration).clamp(-SOONER_MOST, SOONER_MOST)
    columns = {
        "log_away": (distance * unit).log1p(),
        "log_rival": (rival * unit).log1p(),
        "away": distance * unit / AWAY_SCALE,
        "slack": (t_max - now[..., None] - duration) / t_max,
        "log_next": (first * unit).log1p(),
        "log_second": (second * unit).log1p(),
        "log_excess": excess[0],
        "sooner": sooner * unit / AWAY_SCALE,
        "turn": _turn(state, active, distance),
        "close": close / CLOSE_SCALE,
        "log_excess_next": excess[1],
    }
    return torch.stack([columns[name] for name in PAIR], dim=-1) * free[..., None], drawn


def _relative_to_nearest(
    free: Tensor, distance: Tensor, ahead: Tensor, rival: Tensor, unit: Tensor
) -> tuple[tuple[Tensor, Tensor], dict[str, Tensor]]:
    """Distance, and distance with the next leg, in excess of the least; and (B, P) the nearest, the
    greatest lead over rivals and the share of waypoints that are this UAV's own ground.
    """

    def least(value: Tensor) -> Tensor:
        return torch.where(free, value, torch.inf).amin(-1, keepdim=True)

    def excess(value: Tensor) -> Tensor:
        return torch.where(free, (value - least(value)) * unit, 0.0).clamp(min=0).log1p()

    left = free.sum(-1)
    own_ground = (free & (distance < rival)).sum(-1) / left.clamp(min=1)
    nearest = (least(distance) * unit).log1p().squeeze(-1)
    lead = (least(distance - rival) * unit).clamp(-LEAD_MOST, LEAD_MOST).squeeze(-1) / AWAY_SCALE
    drawn = {"nearest": nearest, "lead": lead, "own_ground": own_ground}
    drawn = {name: torch.where(left > 0, value, 0.0) for name, value in drawn.items()}
    return (excess(distance), excess(ahead)), drawn


def _rivals(state: RolloutState, active: Tensor, now: Tensor) -> tuple[Tensor, Tensor]:
    """Distance (B, P, W) of the nearest other UAV in flight, and the least time until one of them
    could be at each waypoint.
    """
    waypoints = state.batch.waypoints[:, None].expand(-1, active.shape[1], -1, -1)
    gap = torch.cdist(waypoints, state.target, compute_mode="donot_use_mm_for_euclid_dist")
    out = state.done.scatter(-1, active[..., None], True)[..., None, :]
    wait = (state.arrive - now[..., None]).clamp(min=0)[..., None, :]
    soonest = wait + gap / state.batch.speed[:, None, None]
    rival = torch.where(out, torch.inf, gap).amin(-1).clamp(max=NO_RIVAL)
    return rival, torch.where(out, torch.inf, soonest).amin(-1).clamp(max=NO_RIVAL)


def _others(waypoints: Tensor, free: Tensor, unit: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Distances (B, P, W) from each waypoint to the nearest and second nearest unvisited other,
    and how many are close.
    """
    gap = torch.cdist(waypoints, waypoints, compute_mode="donot_use_mm_for_euclid_dist")
    itself = torch.eye(gap.shape[-1], dtype=torch.bool, device=gap.device)
    gap = torch.where(itself, torch.inf, gap)[:, None]
    gap = torch.where(free[..., None, :], gap, torch.inf)
    close = (gap * unit[..., None] <= CLOSE).sum(-1)
    nearest = gap.topk(min(2, gap.shape[-1]), largest=False).values.clamp(max=NO_RIVAL)
    return nearest[..., 0], nearest[..., -1], close


def _turn(state: RolloutState, active: Tensor, distance: Tensor) -> Tensor:
    """Cosine (B, P, W) between the last leg and the next; 0 before the first."""
    here = row_of(state.target, active)[..., None, :]
    heading = here - row_of(state.origin, active)[..., None, :]
    along = ((state.batch.waypoints[:, None] - here) * heading).sum(-1)
    return along / (heading.norm(dim=-1) * distance).clamp(min=LEAST_LENGTH)
