"""Results as files and objects for other programs."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from jfto.analysis.comparison import ALGORITHMS, AlgorithmResult, Comparison, LinkMetrics
from jfto.analysis.paper import PAPER, PaperRow
from jfto_msgs_py.certificate import Certificate
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.files import write_file
from jfto_msgs_py.plan import Plan

if TYPE_CHECKING:
    from jfto.planning.survey import Survey
    from jfto_planner.coverage import Coverage

_WAYPOINT_SUFFIXES = (".csv", ".geojson")


def plain(value: object, digits: int | None = None) -> Any:
    """Records, arrays and containers as values that JSON has: what is not finite becomes null.

    With `digits` numbers are rounded to so many decimals.
    """
    if is_dataclass(value):
        return plain({one.name: getattr(value, one.name) for one in fields(value)}, digits)
    if isinstance(value, Mapping):
        return {key: plain(one, digits) for key, one in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [plain(one, digits) for one in value]
    if isinstance(value, float):
        return (value if digits is None else round(value, digits)) if math.isfinite(value) else None
    return value


def comparison_object(plan: Plan, comparison: Comparison, scene: str) -> dict[str, Any]:
    """The comparison as plain values; `inf` is written as null."""
    theirs = PAPER.get(scene, {})
    algorithms = {
        result.name: {
            "traverses_all": result.traverses_all,
            **_links_object(result.linked),
            "active_links": _links_object(result.active),
            "degree_min": result.degree.min(),
            "degree_mean": result.degree.mean(),
            "degree_max": result.degree.max(),
            "energy_j": result.energy_j,
            "paper": _paper_object(theirs.get(result.name)),
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


def _links_object(links: LinkMetrics) -> dict[str, float]:
    return {
        "connectivity_rate": links.connectivity_rate,
        "throughput_mbps": links.mean_throughput_mbps,
        "hops": links.hops,
    }


def _paper_object(row: PaperRow | None) -> dict[str, Any] | None:
    if row is None:
        return None
    return {
        "traverses_all": row.traverses_all,
        "connectivity_rate": row.connectivity_rate,
        "throughput_mbps": row.throughput,
        "hops": row.hops,
    }


def comparison_csv(rows: list[tuple[str, Comparison]]) -> str:
    """One line per scene and algorithm, ours and the paper's."""
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(
        [
            "scene",
            "algorithm",
            "traverses_all",
            "connectivity_rate",
            "throughput_mbps",
            "hops",
            "degree_min",
            "degree_mean",
            "degree_max",
            "energy_j",
            "paper_traverses_all",
            "paper_connectivity_rate",
            "paper_throughput_mbps",
            "paper_hops",
        ]
    )
    for scene, comparison in rows:
        for result in comparison.results:
            paper = PAPER.get(scene, {}).get(result.name)
            theirs: list[object] = ["", "", "", ""]
            if paper is not None:
                hops = "" if paper.hops is None else paper.hops
                theirs = [paper.traverses_all, paper.connectivity_rate, paper.throughput, hops]
            writer.writerow(
                [
                    scene,
                    result.name,
                    result.traverses_all,
                    f"{result.linked.connectivity_rate:.6f}",
                    f"{result.linked.mean_throughput_mbps:.3f}",
                    f"{result.linked.hops:.4f}",
                    result.degree.min(),
                    f"{result.degree.mean():.4f}",
                    result.degree.max(),
                    f"{result.energy_j.sum():.3f}",
                    *theirs,
                ]
            )
    return table.getvalue()


def slots_csv(plan: Plan, comparison: Comparison) -> str:
    """One line per slot: time, then throughput and degrees of every algorithm."""
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    columns = ("throughput_mbps", "degree_min", "degree_mean", "degree_max")
    writer.writerow(
        [
            "slot",
            "time_s",
            *(f"{r.name} {column}" for r in comparison.results for column in columns),
        ]
    )
    for slot, time in enumerate(plan.slots.times_s):
        row: list[object] = [slot, f"{time:.3f}"]
        for result in comparison.results:
            degree = result.degree[slot]
            row += [
                f"{result.linked.throughput_bps[slot] / 1e6:.3f}",
                degree.min(),
                f"{degree.mean():.3f}",
                degree.max(),
            ]
        writer.writerow(row)
    return table.getvalue()


def comparison_arrays(comparison: Comparison) -> bytes:
    """The whole comparison as a .npz file, which `read_comparison` takes."""
    arrays = {
        "gain": comparison.gain,
        "n_dc": np.array(comparison.n_dc),
        "notes": np.array(comparison.notes, dtype=np.str_),
    }
    for result in comparison.results:
        for name, value in vars(result).items():
            inner = vars(value) if isinstance(value, LinkMetrics) else {"": value}
            arrays |= {f"{result.name}/{name}/{key}": np.array(one) for key, one in inner.items()}
    file = io.BytesIO()
    np.savez_compressed(file, allow_pickle=False, **arrays)
    return file.getvalue()


def read_comparison(path: Path) -> Comparison:
    """A comparison out of its .npz file, which must be whole."""
    with np.load(path, allow_pickle=False) as file:
        arrays = dict(file)

    def metrics(algorithm: str, sense: str) -> LinkMetrics:
        prefix = f"{algorithm}/{sense}/"
        return LinkMetrics(
            links=arrays[prefix + "links"],
            throughput_bps=arrays[prefix + "throughput_bps"],
            connectivity_rate=float(arrays[prefix + "connectivity_rate"]),
            hops=float(arrays[prefix + "hops"]),
        )

    results = [
        AlgorithmResult(
            name=name,
            linked=metrics(name, "linked"),
            active=metrics(name, "active"),
            power_w=arrays[f"{name}/power_w/"],
            degree=arrays[f"{name}/degree/"],
            energy_j=arrays[f"{name}/energy_j/"],
            traverses_all=bool(arrays[f"{name}/traverses_all/"]),
        )
        for name in ALGORITHMS
    ]
    notes = tuple(str(note) for note in arrays["notes"])
    return Comparison(tuple(results), arrays["gain"], int(arrays["n_dc"]), notes)


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
        "notes": [
            {"action": note.action, "waypoint": note.waypoint_id, "reason": note.reason}
            for note in coverage.notes
        ],
    }


def check_waypoint_suffix(path: Path) -> None:
    """Raise InputError unless waypoints can be written in the format that the name asks for."""
    if path.suffix.lower() not in _WAYPOINT_SUFFIXES:
        raise InputError(f"{path}: is no known format. Name it .csv or .geojson.")


def write_waypoints(found: Survey, path: Path) -> None:
    """Write latitude, longitude, altitude and view of every waypoint; raises InputError."""
    check_waypoint_suffix(path)
    positions = np.array([waypoint.position_m for waypoint in found.waypoints]).reshape(-1, 3)
    lat, lon, alt = found.dem.to_geodetic(positions)
    rows = [
        (waypoint, f"{north:.8f}", f"{east:.8f}", f"{up:.3f}")
        for waypoint, north, east, up in zip(found.waypoints, lat, lon, alt, strict=True)
    ]
    if path.suffix.lower() == ".csv":
        table = io.StringIO()
        writer = csv.writer(table, lineterminator="\n")
        writer.writerow(["id", "lat", "lon", "alt", "yaw_deg", "pitch_deg"])
        for waypoint, north, east, up in rows:
            view = (f"{waypoint.yaw_deg:.3f}", f"{waypoint.pitch_deg:.3f}")
            writer.writerow([waypoint.id, north, east, up, *view])
        write_file(path, table.getvalue())
        return
    features = [
        {
            "type": "Feature",
            "geometry": {"type": "Point", "coordinates": [float(east), float(north), float(up)]},
            "properties": {
                "id": waypoint.id,
                "yaw_deg": round(waypoint.yaw_deg, 3),
                "pitch_deg": round(waypoint.pitch_deg, 3),
            },
        }
        for waypoint, north, east, up in rows
    ]
    collection = {"type": "FeatureCollection", "features": features}
    write_file(path, json.dumps(collection, indent=1) + "\n")
