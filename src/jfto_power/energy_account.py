"""The energy of a running mission: what is left to each radio, and the powers that draw on it.

It is kept on disk, so that a restart gives nothing back.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from jfto_msgs_py.core import SET_BACK_NS
from jfto_msgs_py.errors import InputError
from jfto_msgs_py.files import FileKind, read_record, write_record
from jfto_msgs_py.records.fields import Range

_FOREVER_S = 1e6
# Below that share of its budget a UAV has none left: times are whole nanoseconds.
_NOTHING = 1e-7
NotNegative = Annotated[float, Range(0.0)]

_FILE = FileKind(
    "energy account",
    "Name another file, or delete it to start with full budgets.",
    format="jfto-energy",
    version=2,
)


@dataclass(frozen=True)
class EnergyState:
    """Energy left (J) and power in force (W) of each UAV at `at_ns`, out of `budget_j`.

    `charged_from_ns` is since when powers were charged, None where the mission had not begun.
    Raises InputError where the tables do not name the same UAVs.
    """

    at_ns: int
    charged_from_ns: int | None
    budget_j: dict[str, NotNegative]
    left_j: dict[str, NotNegative]
    power_w: dict[str, NotNegative]

    def __post_init__(self) -> None:
        if not self.budget_j.keys() == self.left_j.keys() == self.power_w.keys():
            raise InputError("budget_j, left_j and power_w name different UAVs.")


class EnergyAccount:
    """Energy left (J) and power in force (W) by UAV; knows no clock of its own.

    Powers are charged from the mission's time zero on, `zero_ns`; nothing is while that is None.
    Times are ns since the epoch.
    """

    def __init__(self, budget_j: dict[str, float], zero_ns: int | None = None) -> None:
        self.budget_j = dict(budget_j)
        self.left_j = dict(budget_j)
        self.power_w = dict.fromkeys(budget_j, 0.0)
        self._charged_from_ns: int | None = None
        self._zero_ns = zero_ns
        self._opened_ns: int | None = None
        self._since_ns: int | None = None

    @classmethod
    def resumed(cls, state: EnergyState, now_ns: int) -> EnergyAccount:
        """An account that goes on from a state: while nobody kept it, its powers went on drawing.

        `now_ns` is the clock's time, 0 if it has not begun.
        """
        account = cls(state.budget_j, state.charged_from_ns)
        account.left_j = dict(state.left_j)
        account._charged_from_ns = state.charged_from_ns
        # A clock that is behind the state was set back: nothing is drawn until it goes on.
        account.set_powers(min(state.at_ns, now_ns) if now_ns else state.at_ns, state.power_w)
        return account

    def state(self, now_ns: int) -> EnergyState:
        """The account as it stands, to be resumed from."""
        self.advance(now_ns)
        return EnergyState(
            now_ns,
            self._charged_from_ns,
            dict(self.budget_j),
            dict(self.left_j),
            dict(self.power_w),
        )

    def advance(self, now_ns: int) -> None:
        """Charge the powers in force until now; a clock that was set back begins anew."""
        if self._since_ns is None or self._opened_ns is None:
            self._since_ns = self._opened_ns = now_ns
        elif now_ns < self._since_ns - SET_BACK_NS:
            self._since_ns = now_ns
        elif now_ns > self._since_ns:
            if self._zero_ns is not None:
                self._charge(max(self._since_ns, self._zero_ns), now_ns)
            self._since_ns = now_ns

    def set_powers(self, now_ns: int, power_w: dict[str, float]) -> set[str]:
        """Put powers in force; a UAV that is not named keeps its own. Returns whose has changed."""
        self.advance(now_ns)
        changed = {uav for uav, power in power_w.items() if self.power_w[uav] != power}
        self.power_w.update(power_w)
        return changed

    def set_zero(self, zero_ns: int) -> None:
        """Say when the mission begins, or began: the time since is charged, once.

        What has been charged stays charged, wherever time zero is put later.
        """
        begun_ns = self._charged_from_ns
        if begun_ns is None:
            self._zero_ns, begun_ns = zero_ns, self._since_ns
        if begun_ns is not None and self._opened_ns is not None:
            self._charge(max(zero_ns, self._opened_ns), begun_ns)

    def empty_ns(self) -> int | None:
        """When the first UAV has used up its energy at the powers in force; None: never."""
        if self._since_ns is None or self._zero_ns is None:
            return None
        spans_s = [self.left_j[uav] / power for uav, power in self.power_w.items() if power > 0]
        if not spans_s:
            return None
        return max(self._since_ns, self._zero_ns) + round(min(*spans_s, _FOREVER_S) * 1e9)

    def used_up(self, uav_id: str) -> bool:
        """Whether a UAV has no energy left, but for rounding."""
        return self.left_j[uav_id] <= _NOTHING * self.budget_j[uav_id]

    def _charge(self, from_ns: int, until_ns: int) -> None:
        if until_ns <= from_ns:
            return
        if self._charged_from_ns is None or from_ns < self._charged_from_ns:
            self._charged_from_ns = from_ns
        duration_s = (until_ns - from_ns) / 1e9
        for uav, power_w in self.power_w.items():
            self.left_j[uav] = max(self.left_j[uav] - power_w * duration_s, 0.0)


def open_account(budget_j: dict[str, float], file: Path | None, now_ns: int) -> EnergyAccount:
    """The account in a file, or a new one where no file is named or there is none yet.

    `now_ns` is the clock's time, 0 if it has not begun. Raises InputError where the file is no
    account, or one of other budgets or another fleet.
    """
    if file is None or not file.exists():
        return EnergyAccount(budget_j)
    state = read_record(file, EnergyState, _FILE)
    if state.budget_j != budget_j:
        raise _FILE.fault(f"{file}: was kept for other budgets or another fleet.")
    return EnergyAccount.resumed(state, now_ns)


def write_account(state: EnergyState, file: Path) -> None:
    """Write an account; raises InputError where that cannot be done."""
    write_record(state, file, _FILE)
