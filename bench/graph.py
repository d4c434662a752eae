"""How fast the node graph answers, how it heals, and what it takes.

    python bench/graph.py latency [--slots 300]
    python bench/graph.py heal [--kills 50]
    python bench/graph.py load [--seconds 60]
    python bench/graph.py memory [--minutes 10]
    python bench/graph.py messages [--count 24000]

latency: planner, topology and power run as processes under the supervisor, on simulated time; ten
slots a second, which is slots of 1 s at ten times real time, all poses of a slot are sent at once,
and the time from the last of them to the adjacency and to the schedule of that slot is taken.
Between slots a fixed piece of work is timed too: how much longer it takes at times is how much the
computer itself spreads.

heal: on wall time under `jfto up`, nodes picked at random are killed with -9; the graph is whole
again when the dead node's process is back and what the graph says next has been heard: a schedule
of a newer slot, and, by a late joiner, the latched trajectories.

load: start-up time, resident memory and processor time of each process, recorder included.

memory: planner, topology, power, bridge, simulated vehicles and recorder run under
`jfto up --vehicles sim --record`; resident memory of each is taken every ten seconds once all are
linked.

messages: 1 kB each from one process to another, reliable; status 1 if one is lost.
"""

from __future__ import annotations

import argparse

from jfto_msgs_py.ros.installation import require_ros


def main() -> None:
    """Read the command line and run what it names."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=["latency", "heal", "load", "memory", "messages"])
    parser.add_argument("--slots", type=int, default=300)
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--count", type=int, default=24_000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    require_ros()
    from node_graph import footprint, healing, latency, messages

    if options.what == "latency":
        latency.latency(options.slots)
    elif options.what == "heal":
        healing.heal(options.kills, options.seed)
    elif options.what == "load":
        footprint.load(options.seconds)
    elif options.what == "memory":
        footprint.memory(options.minutes)
    else:
        messages.messages(options.count)


if __name__ == "__main__":
    main()
