"""A node's own parameters, described like scenario keys."""

from __future__ import annotations

import dataclasses

from jfto_msgs_py.scenario.key import Key, keys_of


def option_keys(options_type: type) -> dict[str, Key]:
    """Keys of a node's own options, by name; `options_type` is a dataclass of `param` fields."""
    named = ((key.name.partition(".")[2], key) for key in keys_of(options_type, "own"))
    return {name: dataclasses.replace(key, name=name) for name, key in named}
