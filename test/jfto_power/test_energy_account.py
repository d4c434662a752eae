"""The energy account and its file."""

from __future__ import annotations

import json

import pytest

from jfto_msgs_py.errors import InputError
from jfto_power.energy_account import EnergyAccount, open_account, write_account

BUDGET_J = {"uav1": 10.0, "uav2": 20.0}
NOW_NS = 1_763_776_800 * 10**9


def at(seconds: float) -> int:
    return NOW_NS + round(seconds * 1e9)


def test_only_changes_are_named() -> None:
    """Setting the same power again changes nothing."""
    account = EnergyAccount(BUDGET_J)
    account.set_zero(NOW_NS)
    assert account.set_powers(at(0), {"uav1": 1.0, "uav2": 0.0}) == {"uav1"}
    assert account.set_powers(at(1), {"uav1": 1.0, "uav2": 2.0}) == {"uav2"}
    account.advance(at(3))
    assert account.left_j == {"uav1": 7.0, "uav2": 16.0}


def test_a_restart_charges_the_time_between(tmp_path) -> None:
    """The radio went on sending while nobody kept the account."""
    file = tmp_path / "energy.json"
    first = open_account(BUDGET_J, file, NOW_NS)
    first.set_zero(NOW_NS)
    first.set_powers(at(0), {"uav1": 1.0, "uav2": 2.0})
    write_account(first.state(at(1)), file)
    second = open_account(BUDGET_J, file, at(4))
    second.advance(at(4))
    assert second.left_j == {"uav1": 6.0, "uav2": 12.0}


@pytest.mark.parametrize(("now_s", "left_j"), [(None, 9.0), (-100.0, 9.0)])
def test_a_clock_that_has_not_begun_or_was_set_back_charges_nothing(tmp_path, now_s, left_j):
    """Neither gives energy back nor takes more than time has passed."""
    file = tmp_path / "energy.json"
    first = open_account(BUDGET_J, file, NOW_NS)
    first.set_zero(NOW_NS)
    first.set_powers(at(0), {"uav1": 1.0})
    write_account(first.state(at(1)), file)
    now_ns = 0 if now_s is None else at(now_s)
    second = open_account(BUDGET_J, file, now_ns)
    second.advance(now_ns)
    assert second.left_j["uav1"] == left_j


@pytest.mark.parametrize(
    "change",
    [{"version": 1}, {"left_j": {"uav1": -1.0, "uav2": 1.0}}, {"power_w": {}}, {"at_ns": "soon"},
     {"left_j": None}],
)  # fmt: skip
def test_a_file_that_is_no_account_is_refused(tmp_path, change) -> None:
    """It names the file and says what to do; nothing is overwritten."""
    file = tmp_path / "energy.json"
    write_account(EnergyAccount(BUDGET_J).state(at(0)), file)
    text = json.dumps(json.loads(file.read_text()) | change)
    file.write_text(text)
    with pytest.raises(InputError, match="delete it to start with full budgets"):
        open_account(BUDGET_J, file, NOW_NS)
    assert file.read_text() == text


def test_nothing_is_charged_before_time_zero() -> None:
    """On the pads radios are on at no cost; the lift-off, heard late, is charged from its time."""
    account = EnergyAccount(BUDGET_J)
    account.set_powers(at(-20), {"uav1": 1.0, "uav2": 0.0})
    account.advance(at(0))
    account.set_zero(at(3600))
    account.advance(at(5))
    assert account.left_j["uav1"] == 10.0
    account.set_zero(at(2))
    account.advance(at(6))
    assert account.left_j["uav1"] == pytest.approx(6.0)


def test_what_was_charged_stays_charged_and_is_charged_once() -> None:
    """Time zero moved an hour ahead, as by a planner that restarts, and back: no difference."""
    account = EnergyAccount(BUDGET_J)
    account.set_powers(at(-1), {"uav1": 1.0})
    account.set_zero(at(0))
    account.advance(at(2))
    account.set_zero(at(3600))
    account.advance(at(3))
    account.set_zero(at(0))
    account.advance(at(4))
    assert account.left_j["uav1"] == pytest.approx(6.0)


def test_a_restart_does_not_charge_the_flight_again(tmp_path) -> None:
    """Hearing the lift-off anew, a restarted account knows from when it has charged."""
    file = tmp_path / "energy.json"
    first = open_account(BUDGET_J, file, at(-1))
    first.set_powers(at(-1), {"uav1": 1.0})
    first.set_zero(at(0))
    write_account(first.state(at(2)), file)
    second = open_account(BUDGET_J, file, at(3))
    second.set_zero(at(0))
    second.advance(at(5))
    assert second.left_j["uav1"] == pytest.approx(5.0)


def test_a_clock_that_jumps_costs_what_passes_on_it() -> None:
    """Ahead it is charged for; set back, the time goes on from there."""
    account = EnergyAccount(BUDGET_J)
    account.set_zero(NOW_NS)
    account.set_powers(at(0), {"uav1": 1.0})
    account.advance(at(4))
    account.advance(at(1))
    account.advance(at(2))
    assert account.left_j["uav1"] == pytest.approx(5.0)


def test_when_the_energy_is_used_up_is_known_ahead() -> None:
    """10 J at 2 W last 5 s from time zero on, 20 J at 1 W longer; without power it never ends."""
    account = EnergyAccount(BUDGET_J)
    account.set_powers(at(-3), {"uav1": 2.0, "uav2": 1.0})
    assert account.empty_ns() is None
    account.set_zero(at(0))
    assert account.empty_ns() == at(5)
    account.advance(at(5))
    assert account.used_up("uav1")
    assert not account.used_up("uav2")
    account.set_powers(at(5), {"uav1": 0.0})
    assert account.empty_ns() == at(20)


def test_the_account_charges_what_was_in_force() -> None:
    """Power × time since it was set, never below zero, and time never runs backward."""
    account = EnergyAccount({"uav1": 10.0, "uav2": 1.0}, zero_ns=0)
    account.set_powers(at(0.0), {"uav1": 1.0, "uav2": 0.5})
    account.set_powers(at(4.0), {"uav1": 0.25})
    assert account.left_j == pytest.approx({"uav1": 6.0, "uav2": 0.0})
    account.advance(at(3.0))
    account.advance(at(8.0))
    assert account.left_j["uav1"] == pytest.approx(5.0)
