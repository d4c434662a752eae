"""The radios of simulated vehicles, through the simulator's control socket."""

from __future__ import annotations

import socket
from collections.abc import Mapping

from jfto_power.drivers.driver import RadioError, check_power, check_served

_ANSWER_BYTES = 1024
_TRIES = 3


class SimDriver:
    """Speaks the lines `radio N DBM` and `radio N` (docs/how-to/simulator.md) to a UDP address.

    `numbers` has the vehicle number of each UAV served. `timeout_s` is how long one of three tries
    waits; setting twice is as good as once.
    """

    def __init__(
        self, numbers: Mapping[str, int], address: tuple[str, int], timeout_s: float = 1.0
    ) -> None:
        self._numbers = dict(numbers)
        self._address = address
        self._timeout_s = timeout_s

    def apply(self, uav_id: str, dbm: float) -> float:
        """Set and read back in one exchange."""
        check_power(uav_id, dbm, self._numbers)
        return self._ask(f"radio {self._numbers[uav_id]} {dbm!r}")

    def read(self, uav_id: str) -> float:
        """Ask what is set."""
        check_served(uav_id, self._numbers)
        return self._ask(f"radio {self._numbers[uav_id]}")

    def _ask(self, line: str) -> float:
        where = f"{self._address[0]}:{self._address[1]}"
        # A socket of its own per question: a late answer cannot be taken for another's.
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
            sock.settimeout(self._timeout_s)
            for _ in range(_TRIES):
                try:
                    sock.connect(self._address)
                    sock.send(line.encode())
                    answer = sock.recv(_ANSWER_BYTES).decode("utf-8", "replace")
                except (TimeoutError, ConnectionError):
                    continue
                except OSError as error:
                    raise RadioError(
                        f"'{line}' could not be sent to {where}: {error}. Check the address."
                    ) from error
                return self._power_in(answer, line)
        raise RadioError(
            f"'{line}' got no answer from {where}. Is the simulator running, on this control port?"
        )

    @staticmethod
    def _power_in(answer: str, line: str) -> float:
        verdict, _, rest = answer.partition(" ")
        if verdict == "ok":
            try:
                return float(rest)
            except ValueError:
                raise RadioError(f"'{line}' was answered '{answer}', which is no power.") from None
        # The simulator's own sentence says whose radio it is: the line sent would say less.
        raise RadioError(rest or f"'{line}' was answered '{answer}'.")
