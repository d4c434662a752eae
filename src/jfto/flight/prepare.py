"""From a plan and its vehicles to the job of flying it."""

from __future__ import annotations

from dataclasses import replace

from jfto.flight.gates import Gates
from jfto.flight.job import FlightJob
from jfto.flight.settings import LANDED, ConductSettings, Patience
from jfto.pipeline.run import Run
from jfto.planning.scenario_file import SCENARIO_NAME, LoadedScenario
from jfto.supervision.graph import graph_commands
from jfto.supervision.graph_table import GraphOptions, Vehicles


def prepare(
    loaded: LoadedScenario,
    run: Run,
    vehicles: Vehicles,
    *,
    until: str,
    ask: bool,
    gates: Gates | None = None,
) -> FlightJob:
    """The processes of the graph with all their parameters, and how the flight is conducted."""
    directory = run.plan_path.parent
    fleet = vehicles.given.get("simulated_fleet")
    speedup = 1.0 if fleet is None else fleet["speedup"]
    assert isinstance(speedup, float)
    bridge: dict[str, object] = {}
    patience = Patience()
    if gates is not None:
        bridge |= gates.parameters(fleet)
        wait_s = gates.wait_s(speedup) / speedup
        patience = replace(patience, order_s=patience.order_s + wait_s)
    nodes = graph_commands(
        GraphOptions(
            directory / SCENARIO_NAME,
            directory,
            run.plan_path,
            vehicles,
            # What stays on the ground is no flight, and would be taken for one.
            record=until == LANDED,
            sections=loaded.node_options,
            given={"planner_node": {"await_lift_off": True}, "mavlink_bridge": bridge},
        )
    )
    settings = ConductSettings(
        plan_s=run.plan.landed_s or run.plan.slots.horizon_s,
        until=until,
        ask=ask,
        speedup=speedup,
        patience=patience,
    )
    title = f"{loaded.path.stem}, {len(run.plan.uavs)} UAVs"
    return FlightJob(title, directory, run.plan, tuple(nodes), settings, vehicles.simulated)
