"""The planner node: what it publishes, when it plans, which parameters it takes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import Path
from rclpy.lifecycle import TransitionCallbackReturn
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger
from trajectory_msgs.msg import MultiDOFJointTrajectory

from jfto_msgs_py.errors import InputError, ScenarioError
from jfto_msgs_py.plan_file import read_plan, write_plan
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.vehicle import decode_path, decode_trajectory
from jfto_planner.node.planner_node import PlannerNode
from jfto_world.motion.progress import sample
from support.graph import Graph
from support.plans import side_by_side

IDS = ("uav1", "uav2", "uav3")


def _plan(scenario, progress):
    progress(0.5, "half way")
    return side_by_side(scenario)


@pytest.fixture
def graph():
    """A graph on wall time."""
    with Graph() as found:
        yield found


def _collect(graph: Graph):
    trajectories = {
        uav: graph.collect(MultiDOFJointTrajectory, topics.trajectory(uav), qos.latched())
        for uav in IDS
    }
    paths = {uav: graph.collect(Path, topics.path(uav), qos.latched()) for uav in IDS}
    return trajectories, paths


def test_paths_and_trajectories_are_those_of_the_plan(graph) -> None:
    """A late joiner gets them; stamps are lift-off plus arrival, positions those of the slots."""
    node = graph.add(PlannerNode, _plan, start_time_s=2_000_000_000.5)
    graph.until(lambda: node._plan is not None)
    plan = node._plan
    trajectories, paths = _collect(graph)
    graph.until(lambda: all(trajectories.values()) and all(paths.values()))
    for index, uav in enumerate(IDS):
        path = decode_path(paths[uav][0])
        assert path.points_m[0].tolist() == list(plan.uavs[index].start_m)
        assert path.arrival_ns[0] == 2_000_000_000_500_000_000
        arrival_s = (path.arrival_ns[1:] - path.arrival_ns[0]) / 1e9
        assert np.allclose(arrival_s, plan.routes[index].arrival_s, atol=1e-6)
        trajectory = decode_trajectory(trajectories[uav][0])
        assert trajectory.start_ns == path.arrival_ns[0]
        at_slots = sample(trajectory.offset_ns / 1e9, trajectory.position_m, plan.slots.times_s)
        assert np.allclose(at_slots, plan.positions_m[index], atol=1e-4)
        assert np.linalg.norm(trajectory.velocity_mps[0][:2]) <= plan.uavs[index].speed_mps + 1e-6


def test_replan_answers_when_the_new_plan_is_out(graph) -> None:
    """The service plans anew: a later lift-off, and a message that says what was planned."""
    node = graph.add(PlannerNode, _plan)
    graph.until(lambda: node._plan is not None)
    trajectories, _ = _collect(graph)
    graph.until(lambda: all(trajectories.values()))
    client = graph.observer.create_client(Trigger, topics.REPLAN)
    graph.until(client.service_is_ready)
    future = client.call_async(Trigger.Request())
    graph.until(future.done)
    assert future.result().success
    assert "waypoints" in future.result().message
    graph.until(lambda: all(len(got) == 2 for got in trajectories.values()))
    first, second = (decode_trajectory(message) for message in trajectories["uav1"])
    assert second.start_ns > first.start_ns


def test_a_restart_keeps_plan_and_lift_off(graph, tmp_path) -> None:
    """Planned once, kept, loaded by a node that cannot plan, which lifts off at the same time."""
    files = {"plan_file": str(tmp_path / "plan.json"), "state_file": str(tmp_path / "start.json")}
    first = graph.add(PlannerNode, _plan, **files)
    graph.until(lambda: first._plan is not None)
    start_ns = first._lift_off.start_ns
    graph.remove(first)
    second = graph.add(PlannerNode, **files)
    graph.until(lambda: second._plan is not None)
    assert second._lift_off.start_ns == start_ns
    assert read_plan(tmp_path / "plan.json").slots == second._plan.slots


def test_a_restart_does_not_check_again_what_it_found_sound(graph, tmp_path) -> None:
    """The plan whose lift-off it has kept is taken as it is; one that was changed is checked."""
    files = {"plan_file": str(tmp_path / "plan.json"), "state_file": str(tmp_path / "start.json")}
    first = graph.add(PlannerNode, _plan, **files)
    graph.until(lambda: first._plan is not None)
    graph.remove(first)
    checked: list[str] = []

    def check(path):
        checked.append(path.name)
        return read_plan(path)

    second = graph.add(PlannerNode, None, check, **files)
    graph.until(lambda: second._plan is not None)
    assert checked == []
    graph.remove(second)
    plan = read_plan(tmp_path / "plan.json")
    write_plan(replace(plan, scenario_hash="0" * 64), tmp_path / "plan.json")
    third = graph.add(PlannerNode, None, check, **files)
    graph.until(lambda: third._plan is not None)
    assert checked == ["plan.json"]


def test_an_unsound_plan_is_not_published(graph) -> None:
    """A plan whose certificate lists violations is refused; replan and diagnostics say why."""

    def apart(scenario, progress):
        return side_by_side(scenario, spacing_m=5.0)

    statuses = graph.collect(DiagnosticArray, topics.DIAGNOSTICS, qos.default())
    node = graph.add(PlannerNode, apart)
    graph.until(lambda: any("not published" in m.status[0].message for m in statuses))
    assert node._plan is None
    client = graph.observer.create_client(Trigger, topics.REPLAN)
    graph.until(client.service_is_ready)
    future = client.call_async(Trigger.Request())
    graph.until(future.done)
    assert not future.result().success
    assert "not published" in future.result().message


def test_a_plan_for_another_fleet_is_refused(graph, tmp_path) -> None:
    """The sentence names both fleets."""
    donor = graph.add(PlannerNode, _plan)
    graph.until(lambda: donor._plan is not None)
    uavs = (replace(donor._plan.uavs[0], id="other"), *donor._plan.uavs[1:])
    write_plan(replace(donor._plan, uavs=uavs), tmp_path / "other.json")
    graph.remove(donor)
    node = graph.add(PlannerNode, plan_file=str(tmp_path / "other.json"))
    graph.until(lambda: node._trouble)
    assert "other, uav2, uav3" in node._trouble


def test_a_planner_that_fails_stays_alive(graph) -> None:
    """Whatever planning raises is told, and the node goes on."""

    def broken(scenario, progress):
        raise ZeroDivisionError("no idea")

    node = graph.add(PlannerNode, broken)
    graph.until(lambda: node._trouble)
    assert "no idea" in node._trouble


def test_without_any_source_of_plans_it_does_not_start(graph) -> None:
    """No plan function and no file: an error that says what to do."""
    with pytest.raises(InputError, match="Name a plan file"):
        graph.add(PlannerNode)


def test_wrong_parameters_at_start(graph) -> None:
    """Unknown names and values out of range are all listed before anything is done."""
    with pytest.raises(ScenarioError) as caught:
        graph.add(
            PlannerNode, _plan, radio__bandwith_hz=1e6, network__delta=500, start_delay_s=-1.0
        )
    text = "\n".join(caught.value.problems)
    assert "Did you mean radio.bandwidth_hz?" in text
    assert "network.delta is 500" in text
    assert "start_delay_s is -1" in text


def test_parameters_are_described_and_checked_when_set(graph) -> None:
    """Range and unit in the descriptor; refused while active; a wrong one gets a sentence."""
    node = graph.add(PlannerNode, _plan, mission__d_min_m=12)
    descriptor = node.describe_parameter("mission.d_min_m")
    assert descriptor.floating_point_range[0].to_value == 1000.0
    assert "Least distance between two UAVs" in descriptor.description
    assert " m]" in descriptor.description
    assert node.get_parameter("mission.d_min_m").value == 12.0

    def set_one(name, value):
        return node.set_parameters([Parameter(name, value=value)])[0]

    assert "deactivate first" in set_one("mission.d_min_m", 20.0).reason
    assert "deactivate first" in set_one("start_delay_s", 1.0).reason
    node.trigger_deactivate()
    assert "2 neighbours" in set_one("network.k_min", 3).reason
    assert "out of range" in set_one("start_delay_s", -1.0).reason
    assert "Wrong parameter type" in set_one("mission.d_min_m", "far").reason
    assert "read-only" in set_one("autostart", False).reason
    assert set_one("mission.d_min_m", 20.0).successful
    assert node.trigger_activate() == TransitionCallbackReturn.SUCCESS
    graph.until(lambda: node._plan is not None)
    assert node._plan.d_min_m == 20.0


def test_a_plan_file_is_not_for_parameters_set_since(graph, tmp_path) -> None:
    """Other parameters make another plan, which replaces the one in the file."""
    file = tmp_path / "plan.json"
    node = graph.add(PlannerNode, _plan, plan_file=str(file))
    graph.until(lambda: node._plan is not None)
    node.trigger_deactivate()
    assert node.set_parameters([Parameter("mission.d_min_m", value=20.0)])[0].successful
    node.trigger_activate()
    graph.until(lambda: node._plan is not None)
    assert node._plan.d_min_m == 20.0
    assert read_plan(file).d_min_m == 20.0


def test_fleet_can_be_changed_atomically(graph) -> None:
    """Count and names together; publishers follow when the node is active again."""
    node = graph.add(PlannerNode, _plan)
    graph.until(lambda: node._plan is not None)
    node.trigger_deactivate()
    result = node.set_parameters_atomically(
        [Parameter("fleet.count", value=2), Parameter("fleet.ids", value=["a", "b"]),
         Parameter("starts.count", value=2)]
    )  # fmt: skip
    assert result.successful, result.reason
    node.trigger_activate()
    got = graph.collect(Path, topics.path("b"), qos.latched())
    graph.until(lambda: got)
    assert graph.observer.count_publishers(topics.path("uav1")) == 0


def test_lifecycle_by_hand(graph) -> None:
    """Without autostart nothing is made until configure, and cleanup takes it away again."""
    node = graph.add(PlannerNode, _plan, autostart=False)
    assert graph.observer.count_publishers(topics.path("uav1")) == 0
    node.trigger_configure()
    graph.until(lambda: graph.observer.count_publishers(topics.path("uav1")) == 1)
    assert node._plan is None
    node.trigger_activate()
    graph.until(lambda: node._plan is not None)
    node.trigger_deactivate()
    node.trigger_cleanup()
    graph.until(lambda: graph.observer.count_publishers(topics.path("uav1")) == 0)
    assert node.trigger_configure() == TransitionCallbackReturn.SUCCESS


def test_a_state_file_that_is_none_is_told(graph, tmp_path) -> None:
    """The planner does not overwrite a file that is something else."""
    file = tmp_path / "start.json"
    file.write_text("{}")
    node = graph.add(PlannerNode, _plan, state_file=str(file))
    graph.until(lambda: node._trouble)
    assert "delete it" in node._trouble
    assert file.read_text() == "{}"
