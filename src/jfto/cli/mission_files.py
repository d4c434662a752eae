"""What `jfto mission` writes for other programs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from jfto.cli.mission_options import build
from jfto_msgs_py.mission_file import FORMATS
from jfto_msgs_py.mission_file.write_litchi import WAYPOINTS_MAX
from jfto_msgs_py.mission_file.write_wpml import DEFAULT_DRONE

FORMAT_KEYS = tuple(dict.fromkeys(form.key for form in FORMATS))


def export_files(
    plan_path: Path, out: Path, key: str, drone: str | None, choices: Mapping[str, Any]
) -> int:
    """Write a plan into a folder in the format of a key, and say what was written and lost."""
    form = next(each for each in FORMATS if each.key == key)
    if form.write is None:
        return _export_missions(plan_path, out, form.suffixes[0], choices)
    from jfto.analysis.geo_plan import geo_plan_of
    from jfto.planning.scenario_of_plan import load_scenario_for
    from jfto.planning.terrain import known_ground
    from jfto_msgs_py.files import write_file
    from jfto_msgs_py.plan_file import read_plan

    plan = read_plan(plan_path)
    loaded = load_scenario_for(plan_path, choices["scenario"], choices["overrides"])
    whole = geo_plan_of(plan, known_ground(loaded), plan_path.stem, drone or "")
    parts = {plan_path.stem: whole}
    if form.per_uav:
        flown = [route for route in whole.routes if route.stops]
        parts = {route.uav: replace(whole, name=route.uav, routes=(route,)) for route in flown}
    for name, part in parts.items():
        path = out / f"{name}{form.suffixes[0]}"
        write_file(path, form.write(part))
        count = sum(len(route.stops) for route in part.routes)
        click.echo(f"{path}   {count} waypoints")
        if key == "litchi" and (home := part.routes[0].home) is not None:
            click.echo(
                f"  its heights are above the pad, which Litchi does not name; to read it back: "
                f"--set waypoints.home_deg={home[0]:.7f},{home[1]:.7f}"
            )
        if key == "litchi" and count > WAYPOINTS_MAX:
            click.echo(f"  {path}: Litchi flies {WAYPOINTS_MAX} waypoints at most", err=True)
    if key == "wpml" and drone is None:
        click.echo(
            f"  {out}: written for a drone {DEFAULT_DRONE}, as none was named; others refuse it: "
            "name yours with --drone",
            err=True,
        )
    return 0


def _export_missions(plan_path: Path, out: Path, suffix: str, choices: Mapping[str, Any]) -> int:
    from jfto_mavlink.files import write_mission
    from jfto_mavlink.mission.build import KEEPS_HEADING

    missions = build(plan_path, choices)
    out.mkdir(parents=True, exist_ok=True)
    for uav, mission in missions.items():
        for path in write_mission(out / f"{uav}{suffix}", mission.mission):
            click.echo(f"{path}   {len(mission.mission.items)} items   {mission.digest[:12]}")
    needed = [uav for uav, one in missions.items() if KEEPS_HEADING in one.mission.parameters]
    if needed:
        name, value = KEEPS_HEADING
        click.echo(
            f"  {', '.join(needed)}: fly with {name} {value:g}, or the nose turns along the route. "
            "JFTO sets it for the flight; after an upload by another program, set it there.",
            err=True,
        )
    return 0
