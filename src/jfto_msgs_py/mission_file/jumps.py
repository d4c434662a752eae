"""Jumps of a mission: each leads to an item that is there, by its number in what is sent."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

from jfto_msgs_py.mission_file.document import FileItem, MissionTextError

_JUMP, _TAG, _JUMP_TO_TAG = 177, 600, 601


def with_jumps(items: Sequence[FileItem], numbers: Sequence[int | None]) -> tuple[FileItem, ...]:
    """The items of a mission without home, jumps leading to their numbers as they are sent, from 1.

    `numbers` are those that the file gives its items, None where it gives none. Raises
    MissionTextError for a jump to an item that is not in the mission: the vehicle would end it.
    """
    sent = {given: k for k, given in enumerate(numbers, 1) if given is not None}
    if not sent:
        sent = {k: k for k in range(1, len(items) + 1)}
    tags = {item.params[0] for item in items if item.command == _TAG}
    found = []
    for item in items:
        target = item.params[0]
        if item.command == _JUMP and list(numbers).count(int(target) if target in sent else -1) > 1:
            raise MissionTextError(
                f"{item.place}: jumps to item {target:g}, and two items have that number. Number "
                "them anew."
            )
        if item.command == _JUMP and target not in sent:
            raise MissionTextError(
                f"{item.place}: jumps to item {target:g}, but the mission has items "
                f"{min(sent)} to {max(sent)}. Let it jump to one of them, or remove it."
            )
        if item.command == _JUMP_TO_TAG and target not in tags:
            raise MissionTextError(
                f"{item.place}: jumps to tag {target:g}, which no item sets. Set it, or remove the "
                "jump."
            )
        if item.command == _JUMP and sent[int(target)] != target:
            params = (float(sent[int(target)]), *item.params[1:])
            item = dataclasses.replace(item, params=params)  # noqa: PLW2901  the same item
        found.append(item)
    return tuple(found)
