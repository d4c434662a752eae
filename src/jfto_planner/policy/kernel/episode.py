"""Given routes as an episode, compiled."""

from __future__ import annotations

from jfto_planner.policy.kernel.arrays import Array, Fleet, Scene, View
from jfto_planner.policy.kernel.observe import observe_one, step_one
from jfto_world.compiled import kernel


@kernel
def replay(
    scene: Scene,
    fleet: Fleet,
    view: View,
    routes: Array,
    choices: Array,
    scratch: Array,
    degree: Array,
) -> None:
    """Fly given routes (B, A, L), each ended by W or by L, and record every step.

    `choices` (B, 1, T) receives what was chosen.
    """
    waypoints, longest = scene.waypoints.shape[1], routes.shape[2]
    for b in range(fleet.length.shape[0]):
        for t in range(choices.shape[2]):
            observe_one(scene, fleet, b, 0, t, view, scratch, degree)
            active = view.active[b, 0, t]
            choice = waypoints
            if not fleet.done[b, 0, active]:
                # The place in a route is the number of its waypoints that are visited.
                place = 0
                while (
                    place < longest
                    and routes[b, active, place] < waypoints
                    and fleet.visited[b, 0, routes[b, active, place]]
                ):
                    place += 1
                if place < longest:
                    choice = routes[b, active, place]
            choices[b, 0, t] = choice
            step_one(scene, fleet, b, 0, t, view, choice)
