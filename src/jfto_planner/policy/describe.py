"""Features of a choice as tensors; kernel/observe.py is the compiled twin."""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch
from torch import Tensor

from jfto_planner.policy.features import CLOSE, NO_RIVAL

if TYPE_CHECKING:
    from jfto_planner.policy.environment import Episode


def describe_state(
    episode: Episode,
    active: Tensor,
    now: Tensor,
    others_free: Tensor,
    degree: Tensor,
    drawn: Tensor,
) -> Tensor:
    """T and K of the active UAV and of the fleet, (B, P, STATE_FEATURES); see features.py."""
    batch = episode.batch
    t_max = batch.t_max[:, None].expand_as(episode.arrive)
    own_t_max = t_max.gather(-1, active[..., None]).squeeze(-1)
    left = (~episode.visited).sum(-1).float()
    total = batch.waypoint_valid.sum(-1)[:, None].float()
    flying = (~episode.done).sum(-1).float()
    uavs = batch.uav_valid.sum(-1)[:, None].float()
    capacity = torch.where(episode.done, 0.0, (t_max - episode.arrive).clamp(min=0)).sum(-1)
    need = batch.k_min[:, None].float().clamp(min=1)
    own_degree = degree.gather(-1, active[..., None]).squeeze(-1)
    least = torch.where(batch.uav_valid[:, None], degree, 10**6).amin(-1)
    window = torch.where(torch.isfinite(others_free), others_free - now, 0.0)
    work = 0.7124 * left / total.sqrt()
    columns = (
        now / own_t_max,
        own_t_max - now,
        window,
        left / total,
        flying / uavs,
        (work / capacity.clamp(min=1e-3)).clamp(max=3),
        (own_degree / need).clamp(max=4),
        (least / need).clamp(max=4),
        (~torch.isfinite(others_free)).float(),
    )
    return torch.cat([torch.stack(columns, dim=-1), drawn], dim=-1)


def describe_pairs(
    episode: Episode, active: Tensor, now: Tensor, duration: Tensor, distance: Tensor
) -> tuple[Tensor, Tensor]:
    """What relates the active UAV to each waypoint, (B, P, W, PAIR_FEATURES), 0 where visited, and
    what of it belongs to the state, (B, P, 3).
    """
    batch, free = episode.batch, ~episode.visited
    unit = batch.waypoint_valid.sum(-1)[:, None, None].float().sqrt()
    t_max = batch.t_max[:, None].expand_as(episode.arrive).gather(-1, active[..., None])
    rival, soonest = _rivals(episode, active, now)
    first, second, close = _others(batch.waypoints, free, unit)
    excess, drawn = _relative_to_nearest(free, distance, distance + first, rival, unit)
    columns = (
        (distance * unit).log1p(),
        (rival * unit).log1p(),
        distance * unit / 4,
        (t_max - now[..., None] - duration) / t_max,
        (first * unit).log1p(),
        (second * unit).log1p(),
        excess[0],
        (soonest - duration).clamp(-2, 2) * unit / 4,
        _turn(episode, active, distance),
        close / 8,
        excess[1],
    )
    return torch.stack(columns, dim=-1) * free[..., None], drawn


def _relative_to_nearest(
    free: Tensor, distance: Tensor, ahead: Tensor, rival: Tensor, unit: Tensor
) -> tuple[tuple[Tensor, Tensor], Tensor]:
    """Distance, and distance with the next leg, in excess of the least; and (B, P, 3) the nearest,
    the greatest lead over rivals and the share of waypoints that are this UAV's own ground.
    """

    def least(value: Tensor) -> Tensor:
        return torch.where(free, value, torch.inf).amin(-1, keepdim=True)

    def excess(value: Tensor) -> Tensor:
        return torch.where(free, (value - least(value)) * unit, 0.0).clamp(min=0).log1p()

    left = free.sum(-1)
    own_ground = (free & (distance < rival)).sum(-1) / left.clamp(min=1)
    nearest = (least(distance) * unit).log1p().squeeze(-1)
    lead = (least(distance - rival) * unit).clamp(-8, 8).squeeze(-1) / 4
    drawn = torch.stack((nearest, lead, own_ground), dim=-1)
    return (excess(distance), excess(ahead)), torch.where((left > 0)[..., None], drawn, 0.0)


def _rivals(episode: Episode, active: Tensor, now: Tensor) -> tuple[Tensor, Tensor]:
    """Distance (B, P, W) of the nearest other UAV in flight, and the least time until one of them
    could be at each waypoint.
    """
    waypoints = episode.batch.waypoints[:, None].expand(-1, active.shape[1], -1, -1)
    gap = torch.cdist(waypoints, episode.target, compute_mode="donot_use_mm_for_euclid_dist")
    out = episode.done.scatter(-1, active[..., None], True)[..., None, :]
    wait = (episode.arrive - now[..., None]).clamp(min=0)[..., None, :]
    soonest = wait + gap / episode.batch.speed[:, None, None]
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


def _turn(episode: Episode, active: Tensor, distance: Tensor) -> Tensor:
    """Cosine (B, P, W) between the last leg and the next; 0 before the first."""
    index = active[..., None, None].expand(-1, -1, 1, 3)
    here = episode.target.gather(2, index)
    heading = here - episode.origin.gather(2, index)
    along = ((episode.batch.waypoints[:, None] - here) * heading).sum(-1)
    return along / (heading.norm(dim=-1) * distance).clamp(min=1e-9)
