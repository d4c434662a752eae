"""The facts of a flight as flight.json, which docs/flight.md describes."""

from __future__ import annotations

import math
from typing import Any

from jfto.analysis.facts import FlightFacts
from jfto.analysis.grid import FINER
from jfto.analysis.passages import VISITED_M
from jfto_topology.metrics import average_hops

FLIGHT_FORMAT = "jfto-flight"
FLIGHT_VERSION = 1


def flight_facts_object(facts: FlightFacts) -> dict[str, Any]:
    """All facts as plain values; numbers that are not finite are null. SI units, dB in names."""
    plan, flight, grid = facts.plan, facts.flight, facts.grid
    return {
        "format": FLIGHT_FORMAT,
        "version": FLIGHT_VERSION,
        "scenario_hash": plan.scenario_hash,
        "seed": plan.seed,
        "lift_off": {"unix_s": flight.lift_off_ns / 1e9, "source": flight.lift_off_source},
        "end_s": _number(facts.end_s),
        "complete": flight.complete,
        "notes": list(flight.notes),
        "slots": {
            "planned": plan.slots.count,
            "flown": grid.slots,
            "duration_s": plan.slots.duration_s,
        },
        "waypoints": _waypoints(facts),
        "certificate": _certificate(facts),
        "network": _network(facts),
        "energy": [
            {
                "uav": one.uav,
                "budget_j": one.budget_j,
                "planned_j": _number(one.planned_j),
                "used_j": _number(one.used_j),
                "source": one.source,
            }
            for one in facts.energy
        ],
        "endings": [
            {
                "uav": one.uav,
                "how": one.how,
                "last_s": _number(one.last_s),
                "return_gap_m": _number(one.return_gap_m),
            }
            for one in facts.endings
        ],
        "events": [
            {
                "at_s": _number(flight.seconds(event.stamp_ns)),
                "level": event.level,
                "node": event.node,
                "kind": event.kind,
                "uav": event.uav_id,
                "text": event.text,
            }
            for event in flight.events
        ],
        "troubles": [
            {
                "node": one.node,
                "uav": one.uav,
                "level": one.level,
                "text": one.text,
                "from_s": _number(one.from_s),
                "to_s": _number(one.to_s),
            }
            for one in flight.troubles
        ],
        "per_slot": _per_slot(facts),
    }


def _waypoints(facts: FlightFacts) -> dict[str, Any]:
    return {
        "count": len(facts.passages),
        "visited": facts.visited,
        "within_m": VISITED_M,
        "worst_closest_m": _number(facts.worst_closest_m),
        "worst_late_s": _number(facts.worst_late_s),
        "passages": [
            {
                "uav": one.uav,
                "waypoint": one.waypoint_id,
                "planned_s": _number(one.planned_s),
                "reached_s": _number(one.reached_s),
                "late_s": _number(one.late_s),
                "closest_m": _number(one.closest_m),
            }
            for one in facts.passages
        ],
    }


def _certificate(facts: FlightFacts) -> dict[str, Any]:
    certificate = facts.certificate
    return {
        "slots": len(certificate.clean),
        "clean_slots": int(certificate.clean.sum()),
        "clean_share": _number(certificate.clean_share),
        "slot_checks": certificate.slot_checks,
        "slot_violations": certificate.slot_violations,
        "worst_margin_db": _number(certificate.worst_margin_db),
        "worst_margin_uav": certificate.worst_margin_uav,
        "worst_margin_slot": _number(certificate.worst_margin_slot),
        "least_separation_m": _number(certificate.least_separation_m),
        "least_height_m": _number(certificate.least_height_m),
        "exceptions": [
            {
                "kind": one.kind,
                "uav": one.uav,
                "first_slot": _number(one.first_slot),
                "last_slot": _number(one.last_slot),
                "time_s": _number(one.time_s),
                "value": _number(one.value),
                "limit": _number(one.limit),
                "margin_db": _number(one.margin_db),
                "message": one.message,
                "cause": one.cause,
            }
            for one in certificate.exceptions
        ],
    }


def _network(facts: FlightFacts) -> dict[str, Any]:
    planned, network = facts.planned.linked, facts.network
    degree = network.degree
    return {
        "source": network.source,
        "throughput_mbps": {
            "planned": _number(facts.throughput.planned_mbps),
            "achieved": _number(facts.throughput.achieved_mbps),
            "ratio": _number(facts.throughput.ratio),
        },
        "connectivity_rate": {
            "planned": _number(planned.connectivity_rate),
            "flown": _number(network.connectivity_rate),
        },
        "hops": {
            "planned": _number(average_hops(planned.links)),
            "flown": _number(network.hops),
            "flown_where_linked": _number(network.linked_hops),
        },
        "degree": {
            "least": int(degree.min()),
            "mean": _number(float(degree.mean())),
            "most": int(degree.max()),
        },
    }


def _per_slot(facts: FlightFacts) -> dict[str, list[Any]]:
    """One entry per slot flown, the last for its end."""
    planned = facts.planned.linked.throughput_bps / 1e6
    slots = range(facts.grid.slots + 1)
    return {
        "begin_s": [_number(facts.grid.times_s[slot * FINER]) for slot in slots],
        "clean": [bool(facts.certificate.clean[slot]) for slot in slots],
        "margin_db": [
            _number(facts.certificate.margin_db[slot * FINER : (slot + 1) * FINER].min())
            for slot in slots
        ],
        "planned_mbps": [_number(planned[slot]) if slot < len(planned) else None for slot in slots],
        "achieved_mbps": [_number(value / 1e6) for value in facts.network.throughput_bps],
        "degree_min": facts.network.degree.min(axis=1).tolist(),
        "power_w": [[_number(watt, 6) for watt in row] for row in facts.network.power_w],
    }


def _number(value: float | None, digits: int = 4) -> float | None:
    if value is None or not math.isfinite(value):
        return None
    return round(float(value), digits)
