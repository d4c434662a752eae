"""What the operator is told of powers and energy: once, and when it is over."""

from __future__ import annotations

from collections.abc import Collection

from jfto_msgs_py.core import Episodes
from jfto_msgs_py.records.event import ERROR, INFO, WARN, Event
from jfto_power.horizon import HorizonPower


class PowerEvents:
    """Turns what was solved, and what was not heard, into events."""

    def __init__(self) -> None:
        self._short: Episodes[str] = Episodes(2)
        self._empty: Episodes[str] = Episodes()
        self._silent: Episodes[str] = Episodes()
        self._failed: Episodes[str] = Episodes()

    def of_schedule(self, found: HorizonPower) -> list[Event]:
        """Events after a horizon was solved."""
        uav_ids, shortage = found.schedule.uav_ids, found.shortage
        first = found.schedule.horizon.first
        texts = {}
        if shortage is not None:
            for uav, missing_j, held in zip(
                shortage.uavs, shortage.missing_j, shortage.held_slots, strict=True
            ):
                name = uav_ids[uav]
                texts[name] = (
                    f"{name} lacks {missing_j:.2g} J for the least powers of its topology: it is "
                    f"held until slot {first + int(held)} and silent then, the others go on."
                )
        began, over = self._short.update(texts)
        return [
            *(Event(WARN, "energy", uav, texts[uav]) for uav in began),
            *(
                Event(INFO, "energy", uav, f"{uav} can pay for its least powers again.")
                for uav in over
            ),
        ]

    def of_energy(self, used_up: Collection[str]) -> list[Event]:
        """Events about UAVs that have no energy left."""
        began, _ = self._empty.update(used_up)
        return [
            Event(
                ERROR, "energy", uav, f"{uav} has used up its radio's energy: it is put to silence."
            )
            for uav in began
        ]

    def of_trouble(self, text: str) -> list[Event]:
        """Events about an allocation that failed; "" where it did not."""
        began, over = self._failed.update(["failed"] if text else [])
        if began:
            told = f"Powers could not be solved, the last schedule stays in force: {text}"
            return [Event(ERROR, "power", "", told.replace("\n", " "))]
        return [Event(INFO, "power", "", "Powers are solved again.")] if over else []

    def of_silence(self, silent_s: float, *, run_out: bool) -> list[Event]:
        """Events about a topology that is not heard; 0 s where it is."""
        present = [] if not silent_s else (["silent", "run out"] if run_out else ["silent"])
        began, over = self._silent.update(present)
        events: list[Event] = []
        if "silent" in began:
            text = f"No topology for {silent_s:.0f} s: setpoints go on through its last schedule."
            events.append(Event(WARN, "topology", "", text))
        if "run out" in began:
            text = "The last schedule has run out: its last powers stay in force."
            events.append(Event(ERROR, "topology", "", text))
        if "silent" in over:
            events.append(Event(INFO, "topology", "", "The topology is heard again."))
        return events
