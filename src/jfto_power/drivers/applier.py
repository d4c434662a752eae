"""Setpoints on their way to radios: the newest counts, none too often, none unchecked."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from jfto_msgs_py.errors import JftoError
from jfto_msgs_py.retry import Retry
from jfto_power.drivers.driver import RadioDriver

RETRY = Retry(first_s=2.0, ceiling_s=2.0)


@dataclass(frozen=True)
class RadioState:
    """One radio: what is wanted and what it is set to, dBm; None where that is not known.

    `trouble` says in a sentence why the two differ, "" where they do not.
    """

    uav_id: str
    wanted_dbm: float | None = None
    applied_dbm: float | None = None
    trouble: str = ""


@dataclass
class _Radio:
    state: RadioState
    tried_s: float = -math.inf
    pending: bool = False
    # Tries in a row that came to nothing.
    failed: int = 0


class Applier:
    """Hands setpoints to a driver and keeps an eye on the result; knows no clock of its own.

    A radio is touched at most every `interval_s` seconds; a setpoint that comes earlier waits, and
    a newer one replaces it. A radio that fails or disobeys by more than `tolerance_db` is tried
    again as `retry` says; one that obeys is read again after `recheck_s`, since radios restart.
    """

    def __init__(
        self,
        driver: RadioDriver,
        uav_ids: Sequence[str],
        *,
        interval_s: float = 0.0,
        tolerance_db: float = 1.0,
        retry: Retry = RETRY,
        recheck_s: float = 10.0,
    ) -> None:
        self._driver = driver
        self._radios = {uav_id: _Radio(RadioState(uav_id)) for uav_id in uav_ids}
        self._interval_s, self._tolerance_db = interval_s, tolerance_db
        self._retry = retry
        self._recheck_s = recheck_s

    def state(self, uav_id: str) -> RadioState:
        """What is known of a radio."""
        return self._radios[uav_id].state

    def want(self, uav_id: str, dbm: float) -> None:
        """Take a setpoint over; `step` carries it out."""
        radio = self._radios[uav_id]
        radio.state = RadioState(uav_id, dbm, radio.state.applied_dbm, radio.state.trouble)
        radio.pending = True

    def step(self, now_s: float) -> list[RadioState]:
        """Do what is due at `now_s` seconds; returns the radios that were touched."""
        touched = []
        for radio in self._radios.values():
            if radio.state.wanted_dbm is None or now_s < self._due_s(radio):
                continue
            radio.tried_s = now_s
            radio.state = self._touch(radio.state, radio.pending or bool(radio.state.trouble))
            radio.pending = False
            radio.failed = radio.failed + 1 if radio.state.trouble else 0
            touched.append(radio.state)
        return touched

    def _due_s(self, radio: _Radio) -> float:
        if radio.pending:
            return radio.tried_s + self._interval_s
        wait_s = self._retry.wait_s(radio.failed) if radio.failed else self._recheck_s
        return radio.tried_s + max(math.inf if wait_s is None else wait_s, self._interval_s)

    def _touch(self, state: RadioState, setting: bool) -> RadioState:
        uav_id, wanted = state.uav_id, state.wanted_dbm
        assert wanted is not None
        try:
            applied = self._driver.apply(uav_id, wanted) if setting else self._driver.read(uav_id)
            if not setting and not self._obeys(wanted, applied):
                # It has forgotten what it was told.
                applied = self._driver.apply(uav_id, wanted)
        except JftoError as error:
            return RadioState(uav_id, wanted, None, str(error))
        trouble = ""
        if not self._obeys(wanted, applied):
            trouble = f"It sends at {applied:.2f} dBm where {wanted:.2f} dBm were set."
        return RadioState(uav_id, wanted, applied, trouble)

    def _obeys(self, wanted: float, applied: float) -> bool:
        return wanted == applied or abs(applied - wanted) <= self._tolerance_db + 1e-6
