"""A scenario of your own: from a parameter file to a plan, its certificate and a comparison.

    python examples/own_scenario.py [SCENARIO] [DIRECTORY]

Without arguments examples/valley.yaml is planned, into a folder of temporary files.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import jfto
from jfto_msgs_py.plan_file import write_plan

HERE = Path(__file__).parent


def main(scenario_file: str | None = None, directory: str | None = None) -> None:
    """Plan a scenario and say what its network is worth."""
    # Any key can be overridden, as with --set on the command line; a wrong one is an error.
    scenario = jfto.load_scenario(
        scenario_file or HERE / "valley.yaml", {"radio.fade_margin_db": 2}
    )

    coverage = jfto.cover(scenario)
    print(f"{len(coverage.waypoints)} photos see {100 * coverage.certificate.seen_once:.1f} %")

    plan = jfto.plan(scenario, seed=1)
    certificate = plan.certificate
    assert certificate is not None
    print(f"routes {plan.total_length_m:.0f} m, {plan.slots.horizon_s:.0f} s, clean: {plan.clean}")
    print(f"weakest link {certificate.worst_margin_db:.1f} dB above the sensitivity")
    for violation in certificate.violations:
        print(" ", violation.message)

    print(jfto.compare(plan).table())

    path = Path(directory or tempfile.mkdtemp()) / "plan.json"
    write_plan(plan, path)
    print(f"{path} written: jfto check, jfto run --plan and jfto mission take it")


if __name__ == "__main__":
    main(*sys.argv[1:3])
