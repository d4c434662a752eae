"""What the user is told when a command cannot do what was asked."""

from __future__ import annotations

import json

import click

from jfto_msgs_py.errors import InfeasibleError, JftoError, ScenarioError

EXIT_OTHER = 1
EXIT_INFEASIBLE = 3
EXIT_INTERRUPTED = 130


def show_error(error: JftoError, *, as_json: bool) -> int:
    """Print an expected error in one breath; returns the exit status."""
    problems = error.problems if isinstance(error, ScenarioError) else [str(error)]
    cures = list(error.cures) if isinstance(error, InfeasibleError) else []
    if as_json:
        _echo_json(error.exit_status, problems, cures)
        return error.exit_status
    head = "Infeasible: " if isinstance(error, InfeasibleError) else ""
    for problem in problems:
        click.echo(f"{head}{problem}", err=True)
    if cures:
        click.echo(f"  would help: {' · or '.join(cures)}", err=True)
    if isinstance(error, ScenarioError):
        count = len(problems)
        click.echo(f"{count} problem{'s' if count > 1 else ''}. Nothing was done.", err=True)
    return error.exit_status


def show_unexpected(error: Exception, *, as_json: bool) -> int:
    """Print an error that nobody foresaw; returns the exit status."""
    text = f"Unexpected {type(error).__name__}: {error}"
    if as_json:
        _echo_json(EXIT_OTHER, [text], [])
    else:
        click.echo(f"{text}\nRun the same command with --debug for details to report.", err=True)
    return EXIT_OTHER


def _echo_json(status: int, problems: list[str], cures: list[str]) -> None:
    click.echo(json.dumps({"exit_status": status, "problems": problems, "cures": cures}))
