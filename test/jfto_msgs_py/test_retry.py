"""When to try again, and when to give up."""

from __future__ import annotations

import itertools

from jfto_msgs_py.retry import Retry


def test_waits_grow_up_to_a_ceiling_and_end_with_the_tries() -> None:
    """One wait per try; none longer than the ceiling."""
    retry = Retry(first_s=0.1, ceiling_s=0.5, factor=2.0, tries=5)
    assert list(retry.waits()) == [0.1, 0.2, 0.4, 0.5, 0.5]
    assert retry.wait_s(6) is None


def test_waits_begin_with_the_slower_of_policy_and_link() -> None:
    """A round trip of a slow link is waited for; on a fast one the policy's own first wait is."""
    retry = Retry(first_s=0.2, ceiling_s=2.0, factor=1.5)
    assert next(retry.waits(0.05)) == 0.2
    assert next(retry.waits(0.8)) == 0.8
    assert retry.longer_s(0.8) == 0.8 * 1.5


def test_without_a_number_of_tries_nothing_is_given_up() -> None:
    """Also after so many failures that a power of the factor would overflow."""
    retry = Retry(first_s=1.0, ceiling_s=1.0)
    assert set(itertools.islice(retry.waits(), 5)) == {1.0}
    assert retry.wait_s(100_000) == 1.0
