"""What is kept of a flight on disk."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from jfto_mavlink.flight.follow import FlightRecord
from jfto_msgs_py.records.event import Event


def new_flight_directory(wanted: Path | None) -> Path:
    """A directory for logs: the one wanted, or flight-<UTC time> here."""
    stamp = datetime.now(timezone.utc).strftime("%Y%m%dT%H%M%SZ")
    directory = wanted or Path(f"flight-{stamp}")
    directory.mkdir(parents=True, exist_ok=True)
    return directory


def flight_object(records: Mapping[str, FlightRecord], events: Sequence[Event]) -> dict[str, Any]:
    """A whole flight for JSON: vehicles and what happened, times in s of the bridge's clock."""
    return {
        "vehicles": {uav: record_object(record) for uav, record in records.items()},
        "events": [
            {"at_s": round(e.stamp_ns / 1e9, 3), "uav": e.uav_id, "kind": e.kind, "text": e.text}
            for e in events
        ],
    }


def record_object(record: FlightRecord) -> dict[str, Any]:
    """A flight record for JSON; distances in m, times in s from lift-off."""
    return {
        "ended": record.ended,
        "duration_s": round(record.duration_s, 3),
        "modes": record.modes,
        "waypoints": [
            {
                "id": p.waypoint_id,
                "planned_s": p.planned_s,
                "reached_s": None if p.reached_s is None else round(p.reached_s, 3),
                "closest_m": round(p.closest_m, 3) if math.isfinite(p.closest_m) else None,
            }
            for p in record.passages
        ],
    }
