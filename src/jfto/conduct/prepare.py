"""From a plan and its vehicles to the job of flying it."""

from __future__ import annotations

from collections.abc import Mapping

from jfto.conduct.flight_job import FlightJob
from jfto.conduct.settings import LANDED, ConductSettings
from jfto.pipeline.directory import SCENARIO_NAME
from jfto.pipeline.run import Run
from jfto.planning.scenario_file import LoadedScenario
from jfto.supervision.graph import GraphOptions, graph_commands
from jfto.supervision.vehicles import Vehicles

_GUIDED = "bezier"


def prepare(
    loaded: LoadedScenario, run: Run, vehicles: Vehicles, *, until: str, ask: bool
) -> FlightJob:
    """The processes of the graph with all their parameters, and how the flight is conducted."""
    directory = run.plan_path.parent
    guided = run.plan.time_model == _GUIDED
    parameters = _joined(
        vehicles.merged(loaded.node_options),
        {"planner_node": {"await_lift_off": True}, "mavlink_bridge": {"guided": guided}},
    )
    nodes = graph_commands(
        GraphOptions(
            directory / SCENARIO_NAME,
            directory,
            run.plan_path,
            bridge=True,
            simulate=vehicles.simulated,
            # What stays on the ground is no flight, and would be taken for one.
            record=until == LANDED,
            parameters=parameters,
        )
    )
    speedup = vehicles.given.get("simulated_fleet", {}).get("speedup", 1.0)
    assert isinstance(speedup, float)
    settings = ConductSettings(
        plan_s=run.plan.slots.horizon_s,
        until=until,
        ask=ask,
        speedup=speedup,
        ends_itself=not guided,
    )
    title = f"{loaded.path.stem}, {len(run.plan.uavs)} UAVs"
    return FlightJob(title, directory, run.plan, tuple(nodes), settings, vehicles.simulated)


def _joined(*layers: Mapping[str, Mapping[str, object]]) -> dict[str, dict[str, object]]:
    """Parameters by node; of those in several layers the last wins."""
    joined: dict[str, dict[str, object]] = {}
    for layer in layers:
        for name, values in layer.items():
            joined.setdefault(name, {}).update(values)
    return joined
