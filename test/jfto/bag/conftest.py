"""Recorded bags."""

from __future__ import annotations

from pathlib import Path

import pytest

_BAGS = Path(__file__).parents[2] / "data" / "bags"


@pytest.fixture
def bags(monkeypatch) -> Path:
    """Folder of the bags, which is also the current one, in UTC as when they were recorded."""
    monkeypatch.chdir(_BAGS)
    monkeypatch.setenv("TZ", "UTC")
    return _BAGS
