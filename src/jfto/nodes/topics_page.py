"""The page docs/reference/topics.md: topics, types, QoS and the nodes' parameters, from the code.

`python -m jfto.nodes.topics_page` prints it.
"""

from __future__ import annotations

from typing import Any

from jfto.node_options import NODE_OPTIONS
from jfto_msgs_py.records.event import KINDS
from jfto_msgs_py.ros.endpoints import SERVICES, TOPICS
from jfto_msgs_py.ros.installation import require_ros

_HEAD = """\
# Topics, services and parameters of the node graph

Only stock types of common_interfaces are used, so that any ROS 2 machine can echo, record and plot
them unbuilt. `<uav>` stands for a UAV's id, the fleet's `fleet.ids`. This page is printed by
`python -m jfto.nodes.topics_page`.

Multi-arrays describe themselves in the labels of their dimensions:
`slot;first=45;t0=1763776800.250000000;dt=3.0` (first slot, its beginning in seconds since the
epoch, length of a slot in seconds), `uav;ids=uav1,uav2,uav3`, `bound;min,max;unit=W`.
"""
_LIFECYCLE = """\
All nodes are lifecycle nodes: `ros2 lifecycle set /topology_node deactivate` silences one. With
`autostart` they configure and activate themselves. Parameters can be set while a node is not
active, and take effect when it is activated; the answer to a wrong one is a sentence that says what
would be right.
"""


def page() -> str:
    """Markdown page of all topics, services and parameters of nodes."""
    require_ros()
    lines = [_HEAD, "## Topics", "", "| topic | type | QoS | by | to | content |"]
    lines.append("|---|---|---|---|---|---|")
    for topic in TOPICS:
        by, to = ", ".join(topic.by), ", ".join(topic.to)
        lines.append(
            f"| `{topic.name}` | {topic.type} | {_qos(topic.qos())} | {by} | {to} | {topic.doc} |"
        )
    lines += ["", "## Kinds of events", "", "| kind | what happened |", "|---|---|"]
    lines += [f"| `{kind}` | {doc} |" for kind, doc in KINDS.items()]
    lines += ["", "## Services", "", "| service | type | by | what it does |", "|---|---|---|---|"]
    lines += [f"| `{s.name}` | {s.type} | {s.by} | {s.doc} |" for s in SERVICES]
    lines += ["", "## Parameters", "", _LIFECYCLE]
    lines.append(
        "Every node declares all keys of a scenario ([scenario.md](scenario.md)), and its own:\n"
    )
    for name, options in NODE_OPTIONS.items():
        if not options:
            continue
        lines += [f"### {name}", "", "| parameter | type | default | range | meaning |"]
        lines.append("|---|---|---|---|---|")
        lines += [
            f"| `{key.name}` | {key.kind} | {key.default} | {key.range_text} | {key.doc} |"
            for key in options.values()
        ]
        lines.append("")
    return "\n".join(lines)


def _qos(profile: Any) -> str:
    words = [profile.reliability.name, profile.durability.name, f"depth {profile.depth}"]
    return ", ".join(word.lower().replace("_", " ") for word in words)


if __name__ == "__main__":
    print(page(), end="")
