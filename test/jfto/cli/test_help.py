"""What --help shows."""

from __future__ import annotations

from collections.abc import Iterator

import click
import pytest

from jfto.cli.main import cli


def _pages(command: click.Command, context: click.Context) -> Iterator[tuple[str, str]]:
    yield context.command_path, command.get_help(context)
    if isinstance(command, click.Group):
        for name in command.list_commands(context):
            child = command.get_command(context, name)
            assert child is not None, f"{context.command_path} {name} is listed but missing"
            yield from _pages(child, click.Context(child, context, name))


PAGES = dict(_pages(cli, click.Context(cli, info_name="jfto")))


@pytest.mark.parametrize("path", PAGES)
def test_every_help_page_reads_well(path: str) -> None:
    """A first sentence, and no formatting code shown to the user."""
    lines = PAGES[path].splitlines()
    assert lines[0].startswith(f"Usage: {path}")
    assert lines[2].strip().endswith((".", ":", ",")) or lines[3].strip()
    assert "\\b" not in PAGES[path]
