"""The key table of docs/reference/scenario.md.

`python -m jfto_msgs_py.scenario.document` prints the page.
"""

from __future__ import annotations

from jfto_msgs_py.records.fields import Key
from jfto_msgs_py.scenario.scenario import KEYS, PARTS, RADIO_SHORTHANDS

_HEAD = """\
# Scenario keys

A scenario is a ROS 2 parameter file: `/**: ros__parameters:` holds what all nodes share, and a
section per node (`planner_node`, `topology_node`, `power_node`, `radio_node`, `mavlink_bridge`)
may refine it.
The command line and the nodes read the same file through the same checks: an unknown key, a value
of another type or outside its range stops everything before it begins. Any key can be overridden
from the command line: `--set radio.antenna_gain_dbi=0`, `--set fleet.p_max_dbm=27,28,29`.

Arrays marked *per UAV* take one entry per UAV, or one for all. This page is printed by
`python -m jfto_msgs_py.scenario.document`.
"""


def page() -> str:
    """Markdown page that describes every key."""
    lines = [_HEAD]
    for prefix, part in PARTS.items():
        lines += [f"## {prefix}", "", (part.__doc__ or "").strip().splitlines()[0], ""]
        lines += ["| key | type | default | range | meaning |", "|---|---|---|---|---|"]
        lines += [_row(key) for name, key in KEYS.items() if name.startswith(f"{prefix}.")]
        for name, targets in RADIO_SHORTHANDS.items():
            if name.startswith(f"{prefix}."):
                both = " and ".join(f"`{target}`" for target in targets)
                lines.append(f"| `{name}` | float | | | Short-hand that sets {both}. |")
        lines.append("")
    return "\n".join(lines)


def _row(key: Key) -> str:
    kind = key.kind
    if key.array:
        kind += " per UAV" if key.per_uav else f" × {key.length}" if key.length else " array"
    return f"| `{key.name}` | {kind} | {_default(key)} | {key.range_text} | {key.doc} |"


def _default(key: Key) -> str:
    if key.array:
        return ", ".join(_number(entry) for entry in key.default)
    return _number(key.default)


def _number(value: object) -> str:
    return f"{value:.10g}" if isinstance(value, float) else str(value)


if __name__ == "__main__":
    print(page(), end="")
