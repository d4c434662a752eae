"""docs/reference/topics.md, and whether the graph really is what it says."""

from __future__ import annotations

from pathlib import Path

from jfto.nodes.pose_player import PosePlayerNode
from jfto.nodes.topics_page import page
from jfto_msgs_py.ros import topics
from jfto_msgs_py.ros.endpoints import SERVICES, TOPICS, UAV
from jfto_planner.node.planner_node import PlannerNode
from jfto_power.node.power_node import PowerNode
from jfto_power.node.radio_node import RadioNode
from jfto_topology.node.topology_node import TopologyNode
from support.graph import SCENARIO, Graph
from support.plans import side_by_side

OURS = ("planner_node", "topology_node", "power_node", "radio_node", "pose_player")
# What every ROS node has.
OF_ROS = ("/rosout", "/parameter_events", "/clock")


def test_the_page_is_up_to_date() -> None:
    """Print it anew with python -m jfto.nodes.topics_page > docs/reference/topics.md."""
    stored = Path(__file__).parents[3] / "docs/reference/topics.md"
    assert stored.read_text(encoding="utf-8") == page()


def _names(name: str) -> list[str]:
    ids = [f"uav{number + 1}" for number in range(SCENARIO["fleet.count"])]
    return [name.replace(UAV, uav) for uav in ids] if UAV in name else [name]


def test_the_table_is_what_the_graph_offers() -> None:
    """Every topic of ours with its type, QoS and node, and no other; every service."""
    with Graph() as graph:
        graph.add(PlannerNode, lambda scenario, progress: side_by_side(scenario))
        for kind in (TopologyNode, PowerNode, RadioNode, PosePlayerNode):
            graph.add(kind)
        look = graph.observer
        graph.until(lambda: set(OURS) <= set(look.get_node_names()))
        listed = set()
        # Every node listens to a clock and reports simulated time; the ground is drawn where asked.
        others = (topics.CLOCK, topics.CLOCK_TAKEN, topics.TERRAIN)
        for topic in [each for each in TOPICS if each.name not in others]:
            for name in _names(topic.name):
                by = {node for node in topic.by if node in OURS}
                to = {node for node in topic.to if node in OURS}
                graph.until(
                    lambda name=name, by=by, to=to: (
                        {info.node_name for info in look.get_publishers_info_by_topic(name)} == by
                        and {info.node_name for info in look.get_subscriptions_info_by_topic(name)}
                        == to
                    )
                )
                listed.add(name)
                for info in look.get_publishers_info_by_topic(name):
                    offered, wanted = info.qos_profile, topic.qos()
                    assert info.topic_type == topic.type
                    assert offered.reliability == wanted.reliability
                    assert offered.durability == wanted.durability
        offered = {name for name, _ in look.get_topic_names_and_types()}
        strange = {name for name in offered - listed if not name.endswith("/transition_event")}
        assert strange <= set(OF_ROS)
        services = dict(look.get_service_names_and_types())
        for service in SERVICES:
            if service.by in OURS:
                assert services[service.name] == [service.type]
