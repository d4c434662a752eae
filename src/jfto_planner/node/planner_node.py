"""The planner in the graph: publishes each UAV's path and trajectory."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path as FilePath
from typing import Any

from nav_msgs.msg import Path
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.task import Future
from std_msgs.msg import Header
from std_srvs.srv import Trigger
from trajectory_msgs.msg import MultiDOFJointTrajectory

from jfto_msgs_py.errors import InfeasibleError, InputError, JftoError, MessageError, PlanError
from jfto_msgs_py.plan_file import plan_tag, read_plan, write_plan
from jfto_msgs_py.records.event import INFO as TOLD
from jfto_msgs_py.records.event import WARN as WARNED
from jfto_msgs_py.records.event import Event
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.diagnostics import ERROR, OK, WARN, Status
from jfto_msgs_py.ros.graph_node import GraphNode
from jfto_msgs_py.ros.lift_off import decode_lift_off, lift_off_of
from jfto_msgs_py.ros.vehicle import encode_path, encode_trajectory
from jfto_msgs_py.scenario import Scenario
from jfto_planner.node.lift_off import LiftOff, sound_plan
from jfto_planner.node.plan_job import PlanJob, Progress
from jfto_planner.options import PlannerOptions
from jfto_planner.plan_trajectory import timed_paths, timed_trajectories

_CLOCK_WAIT_S = 0.1
_KEEP_AHEAD_S = 60.0
PlanFunction = Callable[[Scenario, Progress], Plan]


class PlannerNode(GraphNode[PlannerOptions]):
    """Plans the scenario of its parameters with `plan`, or loads a plan with `load`."""

    answers_later = True

    def __init__(
        self,
        plan: PlanFunction | None = None,
        load: Callable[[FilePath], Plan] = read_plan,
        **arguments: Any,
    ) -> None:
        self._make_plan = plan
        self._load = load
        self._plan: Plan | None = None
        self._lift_off: LiftOff | None = None
        self._heard: Any = None
        self._made = False
        self._job: PlanJob | None = None
        self._planned_for: Scenario | None = None
        self._waiting: list[Future] = []
        self._trouble = ""
        super().__init__("planner_node", PlannerOptions, **arguments)

    def check(self, scenario: Scenario, options: PlannerOptions) -> None:
        """Refuse to be without any source of plans."""
        del scenario
        if self._make_plan is None and not options.plan_file:
            raise InputError("plan_file is empty, and this node cannot plan. Name a plan file.")

    def build(self, scenario: Scenario, options: PlannerOptions) -> None:
        """Publishers per UAV and the service."""
        self._scenario, self._options = scenario, options
        self._paths = {
            uav: self.create_lifecycle_publisher(Path, topics.path(uav), qos.latched())
            for uav in scenario.fleet.ids
        }
        self._trajectories = {
            uav: self.create_lifecycle_publisher(
                MultiDOFJointTrajectory, topics.trajectory(uav), qos.latched()
            )
            for uav in scenario.fleet.ids
        }
        self.create_service(
            Trigger, topics.REPLAN, self._on_replan, callback_group=ReentrantCallbackGroup()
        )
        self.create_subscription(Header, topics.LIFT_OFF, self._on_lift_off, qos.latched())
        self.create_timer(_KEEP_AHEAD_S, self._keep_ahead)
        self._finished = self.create_guard_condition(self._on_finished)
        # Where simulated time has not begun, a finished plan waits for it.
        self._clock_wait = self.create_timer(_CLOCK_WAIT_S, self._on_finished)
        self._clock_wait.cancel()

    def activated(self) -> None:
        """Publish the plan, which is loaded or made first if there is none."""
        if self._plan is not None:
            self._publish()
        elif self._job is None:
            # A plan file is not for parameters that were set since it was read or written.
            self._begin(fresh=self._planned_for not in {None, self._scenario})

    def released(self) -> None:
        """Call off what is being planned, and forget the plan."""
        job, self._job = self._job, None
        if job is not None:
            job.call_off()
        self._answer(success=False, text="The node was cleaned up.")
        self._plan = self._lift_off = None

    def _begin(self, *, fresh: bool) -> None:
        scenario, path = self._scenario, self._options.plan_file
        file = FilePath(path) if path else None
        state = FilePath(self._options.state_file) if self._options.state_file else None
        make = self._make_plan
        load = file is not None and (make is None or (file.exists() and not fresh))

        def work(progress: Progress) -> Plan:
            if load:
                assert file is not None
                return (sound_plan(file, state) if state else None) or self._load(file)
            assert make is not None
            plan = make(scenario, progress)
            if file is not None and (plan.certificate is None or plan.certificate.clean):
                write_plan(plan, file)
            return plan

        if fresh:
            # What was heard was the lift-off of another plan.
            self._heard = None
        self._trouble, self._made = "", not load
        self._job = PlanJob(work, self._finished.trigger)

    def _on_finished(self) -> None:
        job = self._job
        if job is None:
            self._clock_wait.cancel()
            return
        if job.result is not None and self.now_ns() == 0:
            self._clock_wait.reset()
            return
        self._clock_wait.cancel()
        self._job = None
        try:
            if job.error is not None:
                raise job.error
            assert job.result is not None
            self._take(job.result)
        except JftoError as error:
            self._trouble = str(error)
            self.get_logger().error(f"No plan: {error}")
            self._answer(success=False, text=str(error))
            return
        self._answer(success=True, text=self._summary())

    def _take(self, plan: Plan) -> None:
        """Publish a plan if it is for this fleet and sound."""
        ids = tuple(uav.id for uav in plan.uavs)
        if ids != self._scenario.fleet.ids:
            raise PlanError(
                f"The plan is for {', '.join(ids)}, the scenario for "
                f"{', '.join(self._scenario.fleet.ids)}. Give both the same fleet."
            )
        if plan.slots.count != self._scenario.mission.slot_count:
            raise PlanError(
                f"The plan has {plan.slots.count} slots, mission.slot_count is "
                f"{self._scenario.mission.slot_count}. Make them agree."
            )
        if plan.certificate is not None and not plan.certificate.clean:
            first = plan.certificate.violations[0].message if plan.certificate.violations else ""
            raise InfeasibleError(f"The plan breaks its constraints and is not published. {first}")
        self._lift_off = LiftOff(plan, self._options, self.now_ns(), made_now=self._made)
        self._plan, self._planned_for = plan, self._scenario
        if self._heard is not None and self._anchor(self._heard):
            # A planner that starts anew in mid-flight tells nobody of a provisional start.
            return
        self.get_logger().info(self._summary())
        self._publish()

    def _on_lift_off(self, message: Any) -> None:
        if self.intake.take(topics.LIFT_OFF, decode_lift_off, message) is None:
            return
        self._heard = message
        if self._lift_off is not None:
            self._anchor(message)

    def _anchor(self, message: Any) -> bool:
        """Count the plan from when the fleet lifted off, and tell all; whether that was news."""
        assert self._plan is not None
        assert self._lift_off is not None
        before_ns, awaited = self._lift_off.start_ns, self._lift_off.awaited
        try:
            heard_ns = lift_off_of(message, plan_tag(self._plan))
            if not self._lift_off.hear(heard_ns, self.now_ns()):
                return False
        except MessageError as error:
            self.intake.refuse(topics.LIFT_OFF, error)
            text = f"Not taken for a lift-off: {error}. The plan's start stays as it was."
            self.announce(Event(WARNED, "lift_off", "", text))
            return False
        except InputError as error:
            # Better to fly without a file than on the wrong clock.
            self.get_logger().error(str(error))
        moved = "" if awaited else f", {(heard_ns - before_ns) / 1e9:+.1f} s from what was assumed"
        text = f"Lift-off at {heard_ns / 1e9:.3f} s{moved}: plan and slots are counted from there."
        self.announce(Event(TOLD, "lift_off", "", text))
        self._publish()
        return True

    def _keep_ahead(self) -> None:
        if self._lift_off is None:
            return
        try:
            moved = self._lift_off.keep_ahead(self.now_ns())
        except InputError as error:
            moved = True
            self.get_logger().error(str(error))
        if moved:
            self._publish()

    def _publish(self) -> None:
        assert self._plan is not None
        assert self._lift_off is not None
        start_ns = self._lift_off.start_ns
        for uav, trajectory in timed_trajectories(self._plan, start_ns).items():
            self._trajectories[uav].publish(encode_trajectory(trajectory, uav))
        for uav, path in timed_paths(self._plan, start_ns).items():
            self._paths[uav].publish(encode_path(path))

    def _summary(self) -> str:
        plan, lift_off = self._plan, self._lift_off
        assert plan is not None
        assert lift_off is not None
        at = f"at {lift_off.start_ns / 1e9:.3f} s"
        return (
            f"{plan.photo_count} waypoints, {plan.total_length_m / 1000:.2f} km, "
            f"{plan.slots.count} slots of {plan.slots.duration_s:.3f} s, "
            f"lift-off {'awaited' if lift_off.awaited else at}"
        )

    async def _on_replan(self, request: Any, response: Any) -> Any:
        """Plan anew from the parameters; answers when the plan is published or has failed."""
        del request
        if not self.is_active:
            response.message = "The planner is not active. Activate it first."
        elif self._job is not None:
            response.message = "The planner is at work already."
        else:
            answer: Future = Future()
            self._waiting.append(answer)
            self._begin(fresh=True)
            response.success, response.message = await answer
        return response

    def _answer(self, *, success: bool, text: str) -> None:
        waiting, self._waiting = self._waiting, []
        for answer in waiting:
            answer.set_result((success, text))

    def statuses(self, now_ns: int) -> list[Status]:
        """Whether there is a plan, and each UAV's share of it."""
        facts = self.intake.facts("/")
        if self._job is not None:
            text = f"planning, {100 * self._job.share:.0f} % {self._job.note}".rstrip()
            return [Status("", WARN, text, facts), *self._fleet(WARN, "being planned")]
        if self._trouble:
            return [Status("", ERROR, self._trouble, facts), *self._fleet(ERROR, "no plan")]
        if self._plan is None:
            return [Status("", WARN, "not active", facts), *self._fleet(WARN, "no plan")]
        if self._lift_off is not None and not self._lift_off.awaited:
            facts["elapsed_s"] = f"{(now_ns - self._lift_off.start_ns) / 1e9:.1f}"
        uavs = [
            Status(
                uav.id,
                OK,
                f"{len(route.waypoint_ids)} waypoints",
                {"waypoints": str(len(route.waypoint_ids)), "length_m": f"{route.length_m:.1f}"},
            )
            for uav, route in zip(self._plan.uavs, self._plan.routes, strict=True)
        ]
        return [Status("", OK, self._summary(), facts), *uavs]

    def _fleet(self, level: int, text: str) -> list[Status]:
        return [Status(uav, level, text) for uav in self._scenario.fleet.ids]
