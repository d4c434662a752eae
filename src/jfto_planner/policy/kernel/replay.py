"""Given routes as an episode, compiled."""

from __future__ import annotations

import numpy as np

from jfto_msgs_py.types import AnyArray
from jfto_planner.policy.kernel.episode import Episode, new_episode
from jfto_planner.policy.kernel.observe import observe_one, step_one
from jfto_planner.policy.problems import Problems
from jfto_world.compiled import kernel


def fly_routes(problems: Problems[AnyArray], routes: AnyArray) -> tuple[Episode, AnyArray]:
    """Fly given routes (B, A, L), each ended by W or by L; UAVs choose as they become free.

    Returns the episode, of which all steps have been seen, and what was chosen (B, 1, T).
    """
    episode = new_episode(problems, 1, recorded=True)
    choices = np.zeros(episode.seen.active.shape, np.int64)
    _replay(episode, np.array(routes, dtype=np.int64), choices)
    return episode, choices


@kernel
def _replay(episode: Episode, routes: AnyArray, choices: AnyArray) -> None:
    waypoints, longest = episode.problems.waypoints.shape[1], routes.shape[2]
    for b in range(choices.shape[0]):
        for t in range(choices.shape[2]):
            observe_one(episode, b, 0, t)
            active = episode.seen.active[b, 0, t]
            choice = waypoints
            if not episode.done[b, 0, active]:
                # The place in a route is the number of its waypoints that are visited.
                place = 0
                while (
                    place < longest
                    and routes[b, active, place] < waypoints
                    and episode.visited[b, 0, routes[b, active, place]]
                ):
                    place += 1
                if place < longest:
                    choice = routes[b, active, place]
            choices[b, 0, t] = choice
            step_one(episode, b, 0, t, choice)
