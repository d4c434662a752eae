"""The energy account and its file."""

from __future__ import annotations

import json

import pytest

from jfto_msgs_py.errors import InputError
from jfto_power.energy_account import EnergyAccount

BUDGET_J = {"uav1": 10.0, "uav2": 20.0}
NOW_NS = 1_763_776_800 * 10**9


def at(seconds: float) -> int:
    return NOW_NS + round(seconds * 1e9)


def test_only_changes_are_named() -> None:
    """Setting the same power again is no news."""
    account = EnergyAccount(BUDGET_J, None, NOW_NS)
    assert account.set_powers(at(0), {"uav1": 1.0, "uav2": 0.0}) == {"uav1"}
    assert account.set_powers(at(1), {"uav1": 1.0, "uav2": 2.0}) == {"uav2"}
    account.advance(at(3))
    assert account.left_j == {"uav1": 7.0, "uav2": 16.0}


def test_a_restart_charges_the_time_between(tmp_path) -> None:
    """The radio went on sending while nobody kept the book."""
    file = tmp_path / "energy.json"
    first = EnergyAccount(BUDGET_J, file, NOW_NS)
    first.set_powers(at(0), {"uav1": 1.0, "uav2": 2.0})
    first.save(at(1))
    second = EnergyAccount(BUDGET_J, file, at(4))
    second.advance(at(4))
    assert second.left_j == {"uav1": 6.0, "uav2": 12.0}


@pytest.mark.parametrize(("now_s", "left_j"), [(None, 9.0), (-100.0, 9.0)])
def test_a_clock_that_has_not_begun_or_was_set_back_charges_nothing(tmp_path, now_s, left_j):
    """Neither gives energy back nor takes more than time has passed."""
    file = tmp_path / "energy.json"
    first = EnergyAccount(BUDGET_J, file, NOW_NS)
    first.set_powers(at(0), {"uav1": 1.0})
    first.save(at(1))
    now_ns = 0 if now_s is None else at(now_s)
    second = EnergyAccount(BUDGET_J, file, now_ns)
    second.advance(now_ns)
    assert second.left_j["uav1"] == left_j


@pytest.mark.parametrize(
    "change",
    [{"version": 2}, {"left_j": {"uav1": -1.0, "uav2": 1.0}}, {"power_w": {}}, {"at_ns": "soon"},
     {"left_j": None}],
)  # fmt: skip
def test_a_file_that_is_no_account_is_refused(tmp_path, change) -> None:
    """It names the file and says what to do; nothing is overwritten."""
    file = tmp_path / "energy.json"
    EnergyAccount(BUDGET_J, file, NOW_NS).save(at(0))
    text = json.dumps(json.loads(file.read_text()) | change)
    file.write_text(text)
    with pytest.raises(InputError, match="delete it to start with full budgets"):
        EnergyAccount(BUDGET_J, file, NOW_NS)
    assert file.read_text() == text
