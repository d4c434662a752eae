"""The `jfto` command."""

from jfto.cli.main import main

__all__ = ["main"]
