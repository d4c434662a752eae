"""Results as files and objects for other programs."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from jfto.analysis.comparison import Comparison, GroundRates, LinkMetrics
from jfto.analysis.paper import PAPER, paper_row
from jfto_msgs_py.files import plain
from jfto_msgs_py.records.certificate import Certificate
from jfto_msgs_py.records.plan import Plan

if TYPE_CHECKING:
    from jfto_planner.coverage import Coverage


def comparison_object(plan: Plan, comparison: Comparison, scene: str) -> dict[str, Any]:
    """The comparison as plain values; `inf` is written as null."""
    algorithms = {
        result.name: {
            "traverses_all": result.traverses_all,
            **_links_object(result.linked),
            "active_links": _links_object(result.active),
            "degree_min": result.degree.min(),
            "degree_mean": result.degree.mean(),
            "degree_max": result.degree.max(),
            "decades": result.decades,
            "one_band_mbps": result.one_band.throughput_bps[1:].mean() / 1e6,
            "at_once": result.one_band.at_once[1:].mean(),
            "ground": _ground_object(result.ground),
            "heard_min": result.heard.min(),
            "heard_mean": result.heard.mean(),
            "heard_max": result.heard.max(),
            "energy_j": result.energy_j,
            "paper": _paper(scene, result.name) if scene in PAPER else None,
        }
        for result in comparison.results
    }
    found: dict[str, Any] = plain(
        {
            "scene": scene,
            "scenario_hash": plan.scenario_hash,
            "seed": plan.seed,
            "n_dc": comparison.n_dc,
            "algorithms": algorithms,
            "throughput_ratios": comparison.throughput_ratios,
            "notes": comparison.notes,
        }
    )
    return found


def _ground_object(ground: GroundRates | None) -> dict[str, float] | None:
    """Rates to the ground, None without a station."""
    if ground is None:
        return None
    own, shared = ground.mean_mbps
    return {"own_time_mbps": own, "one_band_mbps": shared, "deaf_share": ground.deaf_share}


def _links_object(links: LinkMetrics) -> dict[str, float]:
    return {
        "connectivity_rate": links.connectivity_rate,
        "throughput_mbps": links.mean_throughput_mbps,
        "hops": links.hops,
    }


def comparison_csv(rows: Sequence[tuple[str, Comparison]]) -> str:
    """One line per scene and algorithm, ours and the paper's."""
    return _csv(
        [
            {
                "scene": scene,
                "algorithm": result.name,
                "traverses_all": result.traverses_all,
                "connectivity_rate": f"{result.linked.connectivity_rate:.6f}",
                "throughput_mbps": f"{result.linked.mean_throughput_mbps:.3f}",
                "decades": f"{result.decades:.2f}",
                "one_band_mbps": f"{result.one_band.throughput_bps[1:].mean() / 1e6:.3f}",
                "hops": f"{result.linked.hops:.4f}",
                "degree_min": result.degree.min(),
                "degree_mean": f"{result.degree.mean():.4f}",
                "degree_max": result.degree.max(),
                "heard_min": result.heard.min(),
                "heard_mean": f"{result.heard.mean():.4f}",
                "heard_max": result.heard.max(),
                "energy_j": f"{result.energy_j.sum():.3f}",
                **{f"paper_{name}": value for name, value in _paper(scene, result.name).items()},
            }
            for scene, comparison in rows
            for result in comparison.results
        ]
    )


def slots_csv(plan: Plan, comparison: Comparison) -> str:
    """One line per slot: time, then throughput and degrees of every algorithm."""
    rows: list[dict[str, object]] = []
    for slot, time in enumerate(plan.slots.times_s):
        rows.append({"slot": slot, "time_s": f"{time:.3f}"})
        for result in comparison.results:
            degree, throughput = result.degree[slot], result.linked.throughput_bps[slot] / 1e6
            rows[-1] |= {
                f"{result.name} throughput_mbps": f"{throughput:.3f}",
                f"{result.name} degree_min": degree.min(),
                f"{result.name} degree_mean": f"{degree.mean():.3f}",
                f"{result.name} degree_max": degree.max(),
            }
    return _csv(rows)


def _csv(rows: Sequence[Mapping[str, object]]) -> str:
    """A table with the keys of its first row as header; None is an empty cell."""
    table = io.StringIO()
    writer = csv.DictWriter(table, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return table.getvalue()


def _paper(scene: str, algorithm: str) -> dict[str, object]:
    """The paper's figures by our names; None where it has none."""
    row = paper_row(scene, algorithm)
    return {
        "traverses_all": None if row is None else row.traverses_all,
        "connectivity_rate": None if row is None else row.connectivity_rate,
        "decades": None if row is None else row.throughput,
        "hops": None if row is None else row.hops,
    }


def certificate_object(certificate: Certificate) -> dict[str, Any]:
    """The figures of a certificate and its violations as plain values."""
    found: dict[str, Any] = plain(certificate)
    found["violations"] = [violation.message for violation in certificate.violations]
    return found


def coverage_object(coverage: Coverage) -> dict[str, Any]:
    """The figures of a coverage certificate and what had to be changed."""
    certificate = coverage.certificate
    return {
        "waypoints": len(coverage.waypoints),
        "seen_once": certificate.seen_once,
        "seen_twice": certificate.seen_twice,
        "gsd_mean_cm": 100 * certificate.gsd_mean_m,
        "gsd_std_cm": 100 * certificate.gsd_std_m,
        "gsd_p05_cm": 100 * certificate.gsd_p05_m,
        "gsd_p95_cm": 100 * certificate.gsd_p95_m,
        "incidence_mean_deg": certificate.incidence_mean_deg,
        "incidence_p95_deg": certificate.incidence_p95_deg,
        "distance_m": coverage.distance_m,
        "footprint_m": list(coverage.footprint_m),
        "surface_m2": certificate.surface_m2,
        "heading_deg": coverage.heading_deg,
        "overlaps": plain(coverage.overlaps),
        "notes": [
            {"action": note.action, "waypoint": note.waypoint_id, "reason": note.reason}
            for note in coverage.notes
        ],
    }
