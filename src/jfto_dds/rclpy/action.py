"""Actions, which are not supported."""

from __future__ import annotations

from typing import Any

__all__ = ["ActionClient", "ActionServer"]


def _refuse(name: str) -> Any:
    def __init__(self: Any, *_args: Any, **_kwargs: Any) -> None:  # noqa: N807
        msg = f"jfto_dds does not support rclpy.action.{name}: use topics and services"
        raise NotImplementedError(msg)

    return type(name, (), {"__init__": __init__, "__doc__": f"Would be rclpy's {name}."})


ActionClient = _refuse("ActionClient")
ActionServer = _refuse("ActionServer")


def __getattr__(name: str) -> Any:
    if name.startswith("__"):
        raise AttributeError(name)
    msg = f"jfto_dds does not support rclpy.action.{name}: use topics and services"
    raise NotImplementedError(msg)
