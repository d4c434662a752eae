"""jfto doctor."""

from __future__ import annotations

import click

from jfto.cli.options import json_option


@click.command("doctor")
@json_option
def command(
    as_json: bool,
) -> int:
    """Say what is installed, what is missing, and what to do about it."""
    from jfto.console.results import print_json
    from jfto.doctor import examine

    findings = examine()
    if as_json:
        print_json({"findings": [vars(finding) for finding in findings]})
    else:
        for finding in findings:
            mark = "✓" if finding.good else ("✗" if finding.needed else "–")
            click.echo(f"{mark} {finding.name:<14} {finding.state}")
            if not finding.good and finding.cure:
                click.echo(f"  {'':<14} → {finding.cure}")
    missing = [finding for finding in findings if finding.needed and not finding.good]
    if missing and not as_json:
        click.echo(f"{len(missing)} of the needed parts missing or broken.")
    return 1 if missing else 0
