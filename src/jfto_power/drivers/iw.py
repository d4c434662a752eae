"""A Linux Wi-Fi or mesh radio, by the `iw` tool, aboard the UAV that carries it."""

from __future__ import annotations

import math
import re
import subprocess
from collections.abc import Sequence

from jfto_msgs_py.environment import foreign_environment
from jfto_power.drivers.driver import RadioError, check_power, check_served

_POWER = re.compile(r"^\s*txpower\s+(-?\d+(?:\.\d+)?)\s*dBm\s*$", re.MULTILINE)
# What `iw` says, and what helps.
_CURES = (
    ("-1)", "Changing powers takes CAP_NET_ADMIN: run as root, or give the iw tool that right."),
    ("-19)", "Name the radio's interface (`iw dev` lists them)."),
    ("-95)", "The radio's kernel driver cannot set a power, or not in such small steps."),
    ("-22)", "The channel in use does not allow this power: see `iw reg get` and `iw list`."),
)


class IwDriver:
    """`iw dev IFACE set txpower fixed MBM`, read back by `iw dev IFACE info`.

    The kernel's mac80211 takes whole decibels from 0 dBm up, so the power is rounded up to
    `step_db`, which keeps every link asked for; silence becomes `least_dbm`. `command` is the tool
    with arguments of its own, and `timeout_s` ends a call that hangs.
    """

    def __init__(
        self,
        uav_id: str,
        interface: str,
        *,
        command: Sequence[str] = ("iw",),
        step_db: float = 1.0,
        least_dbm: float = 0.0,
        timeout_s: float = 2.0,
    ) -> None:
        self._served = (uav_id,)
        self._interface = interface
        self._command = tuple(command)
        self._step_db, self._least_dbm = step_db, least_dbm
        self._timeout_s = timeout_s

    def apply(self, uav_id: str, dbm: float) -> float:
        """Set, then read back."""
        check_power(uav_id, dbm, self._served)
        # Rounding in the last bits must not cost a whole step.
        steps = math.ceil(max(dbm, self._least_dbm) / self._step_db - 1e-6)
        millibel = round(100 * steps * self._step_db)
        self._call("set", "txpower", "fixed", str(millibel))
        return self.read(uav_id)

    def read(self, uav_id: str) -> float:
        """The power that the kernel reports for the interface."""
        check_served(uav_id, self._served)
        text = self._call("info")
        found = _POWER.search(text)
        if found is None:
            raise RadioError(
                f"{self._interface} reports no txpower. Is the interface up (ip link set up)?"
            )
        return float(found.group(1))

    def _call(self, *words: str) -> str:
        command = [*self._command, "dev", self._interface, *words]
        shown = " ".join(command)
        try:
            done = subprocess.run(
                command,
                env=foreign_environment(),
                capture_output=True,
                text=True,
                timeout=self._timeout_s,
                check=False,
                stdin=subprocess.DEVNULL,
            )
        except FileNotFoundError:
            raise RadioError(
                f"{self._command[0]} is not installed. Install the package iw, or use driver log."
            ) from None
        except subprocess.TimeoutExpired:
            raise RadioError(
                f"'{shown}' did not end within {self._timeout_s:g} s. Is the radio's driver stuck?"
            ) from None
        except OSError as error:
            raise RadioError(f"'{shown}' could not be run: {error}.") from error
        if done.returncode != 0:
            said = " ".join(done.stderr.split()) or f"exit status {done.returncode}"
            cure = next((cure for mark, cure in _CURES if mark in said), "")
            raise RadioError(f"'{shown}' failed: {said}. {cure}".rstrip())
        return done.stdout
