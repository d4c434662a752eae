"""Time zero of a plan: provisional, heard, kept over restarts, and what is not believed."""

from __future__ import annotations

import pytest
from rcl_interfaces.msg import Log
from std_msgs.msg import Header
from trajectory_msgs.msg import MultiDOFJointTrajectory

from jfto_msgs_py.errors import InputError, MessageError
from jfto_msgs_py.plan_file import plan_tag, write_plan
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.events import decode_event
from jfto_msgs_py.ros.lift_off import encode_lift_off
from jfto_msgs_py.ros.vehicle import decode_trajectory
from jfto_msgs_py.scenario import Given, make_scenario
from jfto_planner.node.lift_off import LiftOff
from jfto_planner.node.planner_node import PlannerNode
from jfto_planner.options import PlannerOptions
from support.fleets import START_NS, at
from support.graph import SCENARIO, Graph
from support.plans import side_by_side

IDS = ("uav1", "uav2", "uav3")
PLAN = side_by_side(
    make_scenario([{name: Given(value, "test") for name, value in SCENARIO.items()}])
)


def _lift_off(made_now: bool = True, now_s: float = 0.0, **options) -> LiftOff:
    return LiftOff(PLAN, PlannerOptions(**options), at(now_s), made_now=made_now)


def test_without_waiting_the_start_is_the_delay_after_the_plan() -> None:
    """Five seconds by default; nothing is awaited, and the clock may pass it."""
    lift_off = _lift_off(now_s=2.0)
    assert lift_off.start_ns == at(7.0)
    assert not lift_off.awaited
    assert not lift_off.keep_ahead(at(100.0))


def test_an_awaited_start_stays_ahead_of_the_clock() -> None:
    """An hour ahead; renewed when half of it has passed, left alone before."""
    lift_off = _lift_off(await_lift_off=True)
    assert lift_off.start_ns == at(3600.0)
    assert not lift_off.keep_ahead(at(1700.0))
    assert lift_off.keep_ahead(at(1801.0))
    assert lift_off.start_ns == at(5401.0)


def test_a_lift_off_is_taken_once() -> None:
    """The same one again changes nothing; another one of this plan is a correction."""
    lift_off = _lift_off(await_lift_off=True)
    assert lift_off.hear(at(20.0), at(21.0))
    assert (lift_off.start_ns, lift_off.awaited) == (at(20.0), False)
    assert not lift_off.hear(at(20.0), at(25.0))
    assert lift_off.hear(at(20.5), at(26.0))
    assert not lift_off.keep_ahead(at(9000.0))


@pytest.mark.parametrize(
    ("made_now", "lift_off_s", "now_s", "reason"),
    [
        (True, -30.0, 2.0, "30 s before the plan was made"),
        (True, 100.0, 2.0, "98 s ahead of this clock"),
        (False, 0.0, 4000.0, "4000 s ago"),
    ],
)
def test_an_absurd_lift_off_is_refused(made_now, lift_off_s, now_s, reason) -> None:
    """Before the plan, in the far future, or so long ago that the flight is over."""
    lift_off = _lift_off(made_now, await_lift_off=True)
    with pytest.raises(MessageError, match=reason):
        lift_off.hear(at(lift_off_s), at(now_s))
    assert lift_off.awaited


def test_a_loaded_plan_may_have_lifted_off_before() -> None:
    """A planner that starts anew in mid-flight, without a state file, takes what it hears."""
    lift_off = _lift_off(made_now=False, now_s=60.0, await_lift_off=True)
    assert lift_off.hear(at(3.0), at(61.0))
    assert lift_off.start_ns == START_NS + 3 * 10**9


def test_the_state_file_keeps_lift_off_and_when_the_plan_was_made(tmp_path) -> None:
    """Restarted after lift-off: the same time zero. Before it: a new one ahead, same plan time."""
    options = {"await_lift_off": True, "state_file": str(tmp_path / "start.json")}
    _lift_off(**options)
    again = _lift_off(made_now=False, now_s=50.0, **options)
    assert again.start_ns == at(3650.0)
    with pytest.raises(MessageError, match="before the plan was made"):
        again.hear(at(-10.0), at(51.0))
    again.hear(at(52.0), at(53.0))
    third = _lift_off(made_now=False, now_s=70.0, **options)
    assert (third.start_ns, third.awaited) == (at(52.0), False)


def test_a_file_that_cannot_be_written_costs_no_lift_off(tmp_path) -> None:
    """Time zero is taken over, and the error names the file."""
    folder = tmp_path / "state"
    folder.mkdir()
    lift_off = _lift_off(await_lift_off=True, state_file=str(folder / "start.json"))
    (folder / "start.json").unlink()
    folder.rmdir()
    folder.write_text("no folder any more")
    with pytest.raises(InputError, match="start"):
        lift_off.hear(at(5.0), at(6.0))
    assert lift_off.start_ns == at(5.0)


def test_the_planner_republishes_when_the_fleet_lifts_off() -> None:
    """An hour ahead first; after the latched lift-off all trajectories begin there, told once."""
    with Graph() as graph:
        graph.add(
            PlannerNode,
            lambda scenario, progress: side_by_side(scenario),
            use_sim_time=True,
            await_lift_off=True,
        )
        got = {
            uav: graph.collect(MultiDOFJointTrajectory, topics.trajectory(uav), qos.latched())
            for uav in IDS
        }
        heard = graph.collect(Log, topics.EVENTS, qos.events())
        bridge = graph.observer.create_publisher(Header, topics.LIFT_OFF, qos.latched())
        graph.at(0.0)
        graph.until(lambda: all(got.values()))
        assert decode_trajectory(got["uav1"][0]).start_ns >= at(3600.0)
        graph.at(30.0)
        for lift_off_s in (28.5, 28.5, 5000.0):
            bridge.publish(encode_lift_off(at(lift_off_s), plan_tag(PLAN)))
            graph.until(lambda: heard)
        graph.until(lambda: len(heard) == 2)
        starts = {uav: [decode_trajectory(each).start_ns for each in got[uav]] for uav in IDS}
    assert all(times[1:] == [at(28.5)] for times in starts.values())
    events = [decode_event(message) for message in heard]
    assert [event.kind for event in events] == ["lift_off", "lift_off"]
    assert events[0].text.startswith("Lift-off at 1763776828.500 s:")
    assert "4970 s ahead of this clock" in events[1].text


def test_a_planner_that_starts_in_mid_flight_publishes_the_flight_s_own_start(tmp_path) -> None:
    """Without a state file, from the latched lift-off: trajectories begin there from the first."""
    write_plan(PLAN, tmp_path / "plan.json")
    with Graph() as graph:
        bridge = graph.observer.create_publisher(Header, topics.LIFT_OFF, qos.latched())
        bridge.publish(encode_lift_off(at(3.0), plan_tag(PLAN)))
        node = graph.add(
            PlannerNode,
            use_sim_time=True,
            await_lift_off=True,
            plan_file=str(tmp_path / "plan.json"),
        )
        got = graph.collect(MultiDOFJointTrajectory, topics.trajectory("uav1"), qos.latched())
        graph.until(lambda: node._heard is not None)
        graph.at(60.0)
        graph.until(lambda: got)
        starts = [decode_trajectory(each).start_ns for each in got]
    assert starts == [at(3.0)]


def test_the_lift_off_of_another_plan_is_refused_and_told(tmp_path) -> None:
    """A stale or foreign one on the same domain moves nothing; the own one still does."""
    write_plan(PLAN, tmp_path / "plan.json")
    with Graph() as graph:
        graph.add(
            PlannerNode,
            use_sim_time=True,
            await_lift_off=True,
            plan_file=str(tmp_path / "plan.json"),
        )
        got = graph.collect(MultiDOFJointTrajectory, topics.trajectory("uav1"), qos.latched())
        heard = graph.collect(Log, topics.EVENTS, qos.events())
        other = graph.observer.create_publisher(Header, topics.LIFT_OFF, qos.latched())
        graph.at(30.0)
        graph.until(lambda: got)
        other.publish(encode_lift_off(at(29.0), "0123456789abcdef"))
        graph.until(lambda: heard)
        assert len(got) == 1
        other.publish(encode_lift_off(at(28.0), plan_tag(PLAN)))
        graph.until(lambda: len(got) == 2)
    assert decode_trajectory(got[1]).start_ns == at(28.0)
    refused = decode_event(heard[0])
    assert refused.kind == "lift_off"
    assert "is of another plan (0123456789abcdef" in refused.text
    assert "ROS_DOMAIN_ID" in refused.text
