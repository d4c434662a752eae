"""The facts of a flight as flight.json, which docs/reference/flight.md describes."""

from __future__ import annotations

from typing import Any

import numpy as np

from jfto.analysis.facts import FlightFacts
from jfto.analysis.grid import FINER
from jfto_msgs_py.files import plain
from jfto_msgs_py.records.passage import VISITED_M

FLIGHT_FORMAT = "jfto-flight"
FLIGHT_VERSION = 1
_DIGITS, _POWER_DIGITS = 4, 6


def flight_facts_object(facts: FlightFacts) -> dict[str, Any]:
    """All facts as plain values; numbers that are not finite are null. SI units, dB in names."""
    plan, flight = facts.plan, facts.flight
    found = {
        "format": FLIGHT_FORMAT,
        "version": FLIGHT_VERSION,
        "scenario_hash": plan.scenario_hash,
        "seed": plan.seed,
        "lift_off": {"source": flight.lift_off_source},
        "end_s": facts.end_s,
        "complete": flight.complete,
        "notes": flight.notes,
        "slots": {"planned": plan.slots.count, "flown": facts.grid.slots},
        "waypoints": _waypoints(facts),
        "certificate": _certificate(facts),
        "network": _network(facts),
        "energy": facts.energy,
        "endings": facts.endings,
        "events": [
            {
                "at_s": flight.seconds(event.stamp_ns),
                "level": event.level,
                "node": event.node,
                "kind": event.kind,
                "uav": event.uav_id,
                "text": event.text,
            }
            for event in flight.events
        ],
        "troubles": flight.troubles,
        "per_slot": _per_slot(facts),
    }
    written: dict[str, Any] = plain(found, _DIGITS)
    # What others count from is written in full.
    written["lift_off"]["unix_s"] = flight.lift_off_ns / 1e9
    written["slots"]["duration_s"] = plan.slots.duration_s
    written["per_slot"]["power_w"] = plain(facts.network.power_w, _POWER_DIGITS)
    return written


def _waypoints(facts: FlightFacts) -> dict[str, object]:
    return {
        "count": len(facts.passages),
        "visited": facts.visited,
        "within_m": VISITED_M,
        "worst_closest_m": facts.worst_closest_m,
        "worst_late_s": facts.worst_late_s,
        "passages": [
            {
                "uav": one.uav,
                "waypoint": one.waypoint_id,
                "planned_s": one.planned_s,
                "reached_s": one.reached_s,
                "late_s": one.late_s,
                "closest_m": one.closest_m,
            }
            for one in facts.passages
        ],
    }


def _certificate(facts: FlightFacts) -> dict[str, object]:
    certificate = facts.certificate
    return {
        "slots": len(certificate.clean),
        "clean_slots": int(certificate.clean.sum()),
        "clean_share": certificate.clean_share,
        "slot_checks": certificate.slot_checks,
        "slot_violations": certificate.slot_violations,
        "worst_margin_db": certificate.worst_margin_db,
        "worst_margin_uav": certificate.worst_margin_uav,
        "worst_margin_slot": certificate.worst_margin_slot,
        "least_separation_m": certificate.least_separation_m,
        "least_height_m": certificate.least_height_m,
        "exceptions": certificate.exceptions,
    }


def _network(facts: FlightFacts) -> dict[str, object]:
    planned, network = facts.planned.linked, facts.network
    degree = network.degree
    return {
        "source": network.source,
        "throughput_mbps": {
            "planned": facts.throughput.planned_mbps,
            "achieved": facts.throughput.achieved_mbps,
            "ratio": facts.throughput.ratio,
        },
        "connectivity_rate": {
            "planned": planned.connectivity_rate,
            "flown": network.connectivity_rate,
        },
        "hops": {
            "planned": planned.hops,
            "flown": network.hops,
            "flown_where_linked": network.linked_hops,
        },
        "degree": {"least": degree.min(), "mean": degree.mean(), "most": degree.max()},
    }


def _per_slot(facts: FlightFacts) -> dict[str, object]:
    """One entry per slot flown, the last for its end; of the plan as many."""
    count = facts.grid.slots + 1
    planned = np.full(count, np.nan)
    known = facts.planned.linked.throughput_bps[:count] / 1e6
    planned[: len(known)] = known
    return {
        "begin_s": facts.grid.times_s[::FINER],
        "clean": facts.certificate.clean,
        "margin_db": np.minimum.reduceat(
            facts.certificate.margin_db, np.arange(0, len(facts.certificate.margin_db), FINER)
        ),
        "planned_mbps": planned,
        "achieved_mbps": facts.network.throughput_bps / 1e6,
        "degree_min": facts.network.degree.min(axis=1),
    }
