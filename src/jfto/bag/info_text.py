"""Facts of a bag as `ros2 bag info` prints them."""

from __future__ import annotations

import time

from jfto.bag.reader import BagFacts

_INDENT = " " * 19


def info_text(facts: BagFacts) -> str:
    """Text of a bag's facts; times of day are local."""
    topics = [
        f"Topic: {topic.name} | Type: {topic.type_name} | Count: {topic.count} | "
        f"Serialization Format: {topic.serialization_format}"
        for topic in facts.topics
    ]
    end_ns = facts.start_ns + facts.duration_ns
    lines = [
        "",
        f"Files:             {f'{chr(10)}{_INDENT}'.join(facts.files)}",
        f"Bag size:          {_size(facts.size_bytes)}",
        f"Storage id:        {facts.storage}",
        f"ROS Distro:        {facts.distro}",
        f"Duration:          {_seconds(facts.duration_ns)}s",
        f"Start:             {_moment(facts.start_ns)}",
        f"End:               {_moment(end_ns)}",
        f"Messages:          {facts.message_count}",
        f"Topic information: {f'{chr(10)}{_INDENT}'.join(topics)}",
        "Service:           0",
        "Service information: ",
    ]
    return "\n".join(lines)


def _size(count: int) -> str:
    value = float(count)
    for unit in ("B", "KiB", "MiB"):
        if value < 1024:
            return f"{value:.0f} {unit}" if unit == "B" else f"{value:.1f} {unit}"
        value /= 1024
    return f"{value:.1f} GiB"


def _seconds(nanoseconds: int) -> str:
    return f"{nanoseconds // 10**9}.{nanoseconds % 10**9:09d}"


def _moment(nanoseconds: int) -> str:
    local = time.localtime(nanoseconds // 10**9)
    text = f"{time.strftime('%b', local)} {local.tm_mday:2d} {time.strftime('%Y %H:%M:%S', local)}"
    return f"{text}.{nanoseconds % 10**9:09d} ({_seconds(nanoseconds)})"
