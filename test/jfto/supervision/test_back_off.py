"""How long a dead process waits for its restart."""

from __future__ import annotations

from jfto.supervision.process import BackOff
from jfto_msgs_py.retry import Retry

RESTARTS = Retry(first_s=0.1, ceiling_s=0.5, factor=2.0, tries=4)


def test_waits_double_up_to_a_limit_and_then_end() -> None:
    """Four early deaths are forgiven, the fifth is not."""
    back_off = BackOff(RESTARTS)
    assert [back_off.wait_s(0.1) for _ in range(5)] == [0.1, 0.2, 0.4, 0.5, None]


def test_a_long_life_wipes_the_slate() -> None:
    """A process that was up long enough starts again at the first wait."""
    back_off = BackOff(RESTARTS)
    early = [back_off.wait_s(0.1) for _ in range(3)]
    assert early[-1] == 0.4
    assert back_off.wait_s(3.0) == 0.1
    assert back_off.wait_s(0.1) == 0.2
