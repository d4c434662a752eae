"""From the last pose of a slot to its adjacency and schedule."""

from __future__ import annotations

import os
import threading
import time

import numpy as np
from geometry_msgs.msg import PoseStamped
from rosgraph_msgs.msg import Clock

from jfto_msgs_py.records.vehicle import VehiclePose
from jfto_msgs_py.ros import qos, topics
from jfto_msgs_py.ros.stamps import encode_time
from jfto_msgs_py.ros.vehicle import encode_pose
from jfto_world.motion.progress import sample
from node_graph.watcher import IDS, UAVS, Watcher, domain, graph

SLOT_S = 0.1


def latency(slots: int) -> None:
    """Print the latency from the last pose to adjacency and schedule."""
    watcher = Watcher(domain())
    clock = watcher.node.create_publisher(Clock, "/clock", 10)
    poses = [
        watcher.node.create_publisher(PoseStamped, topics.pose(uav), qos.sensor()) for uav in IDS
    ]
    first_ns = 1_800_000_000 * 10**9
    with graph(domain(), slots, 0.0, "--use-sim-time", "--start-delay", "1"):
        watcher.until(lambda: clock.get_subscription_count() >= 3, "three nodes on /clock")
        watcher.join_late()

        def planned() -> bool:
            # Best effort: a tick that comes before a subscriber knows its publisher is lost.
            clock.publish(Clock(clock=encode_time(first_ns)))
            return len(watcher.trajectories) == UAVS

        watcher.until(planned, "all trajectories")
        watcher.until(lambda: all(p.get_subscription_count() >= 2 for p in poses), "pose takers")
        plans = [watcher.trajectories[uav] for uav in IDS]
        start_ns = plans[0].start_ns
        duration_ns = max(int(plan.offset_ns[-1]) for plan in plans) / slots
        taken: dict[str, list[float]] = {topics.ADJACENCY: [], topics.POWER_SCHEDULE: []}
        alone: list[float] = []
        tick = threading.Event()
        for slot in range(slots):
            now_ns = start_ns + round((slot + 0.01) * duration_ns)
            clock.publish(Clock(clock=encode_time(now_ns)))
            # Time spreads before the poses do.
            tick.wait(SLOT_S)
            alone.append(_fixed_work_ms())
            messages = [_pose(plan, now_ns) for plan in plans]
            for publisher, message in zip(poses, messages, strict=True):
                publisher.publish(message)
            sent_s = time.perf_counter()
            watcher.until(
                lambda slot=slot: watcher.heard.get(topics.POWER_SCHEDULE, (-1, 0.0))[0] >= slot,
                f"the schedule of slot {slot}",
            )
            for topic, times in taken.items():
                times.append(1e3 * (watcher.heard[topic][1] - sent_s))
    watcher.context.try_shutdown()
    print(f"A = {UAVS}, horizon 10 slots, {slots} slots, load {os.getloadavg()[0]:.1f}")
    for topic, times in taken.items():
        # The first slots load what the kernels need.
        p50, p90, p99 = np.percentile(times[3:], [50, 90, 99])
        print(f"pose to {topic:<26} p50 {p50:5.1f}  p90 {p90:5.1f}  p99 {p99:5.1f} ms")
    p50, p90, p99 = np.percentile(alone, [50, 90, 99])
    print(f"{'the same work each time':<34} p50 {p50:5.1f}  p90 {p90:5.1f}  p99 {p99:5.1f} ms")


def _fixed_work_ms() -> float:
    """Wall time of a loop that takes some 10 ms."""
    begun_s = time.perf_counter()
    sum(number * number for number in range(120_000))
    return 1e3 * (time.perf_counter() - begun_s)


def _pose(plan: object, now_ns: int) -> object:
    at_s = np.array([(now_ns - plan.start_ns) / 1e9])
    east, north, up = sample(plan.offset_ns / 1e9, plan.position_m, at_s)[0].tolist()
    return encode_pose(VehiclePose(now_ns, (east, north, up), 0.0))
