"""The upload protocol against every behaviour recorded from the real autopilot."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import pytest

from jfto_mavlink.dialect import Message, mavlink
from jfto_mavlink.errors import TransferError
from jfto_mavlink.protocol.item import Item
from jfto_mavlink.protocol.upload import Outcome, upload

ITEMS = (Item(16, 0), Item(22, 3, z=10.0), *(Item(16, 3, x=n, z=20.0) for n in range(7)))
ACCEPTED, ERROR, UNSUPPORTED, NO_SPACE = 0, 1, 3, 4
INVALID_SEQUENCE, DENIED, CANCELLED = 13, 14, 15
REPLY_S = 0.005


def request(seq: int) -> Message:
    return mavlink.MAVLink_mission_request_message(255, 191, seq, 0)


def ack(code: int, system: int = 255, component: int = 191, kind: int = 0) -> Message:
    return mavlink.MAVLink_mission_ack_message(system, component, code, kind)


@dataclass
class Copter:
    """Answers an upload by the recorded rules. `drop` names sendings to lose by their number."""

    expected: int | None = None
    count: int = 0
    held: list[int] = field(default_factory=list)
    lose_in: frozenset[int] = frozenset()
    lose_out: frozenset[int] = frozenset()
    refuse: dict[int, int] = field(default_factory=dict)
    heard: int = 0
    said: int = 0

    def __call__(self, message: Message, now_s: float) -> Iterator[tuple[float, Message]]:
        self.heard += 1
        if self.heard in self.lose_in:
            return
        for reply in self.react(message, now_s):
            self.said += 1
            if self.said not in self.lose_out:
                yield REPLY_S, reply

    def react(self, message: Message, now_s: float) -> Iterator[Message]:
        kind = message.get_type()
        if kind == "MISSION_COUNT":
            self.expected, self.count, self.held = 0, message.count, []
            yield request(0) if message.count else ack(ACCEPTED)
        elif kind == "MISSION_ITEM_INT":
            if self.expected is None:
                yield ack(ERROR)
            elif message.seq != self.expected:
                yield ack(INVALID_SEQUENCE)
            elif message.seq in self.refuse:
                self.expected = None
                yield ack(self.refuse[message.seq])
            else:
                self.held.append(message.seq)
                self.expected += 1
                if self.expected < self.count:
                    yield request(self.expected)
                else:
                    self.expected = None
                    yield ack(ACCEPTED)


def test_a_clean_upload_sends_each_item_once(rig):
    """One answer per question, accepted at the end."""
    copter = Copter()
    assert rig.run(upload(rig.context, ITEMS), copter) is Outcome.ACCEPTED
    assert copter.held == list(range(9))
    assert rig.sent_types() == ["MISSION_COUNT"] + ["MISSION_ITEM_INT"] * 9


def test_an_empty_mission_is_accepted_at_once(rig):
    """Count 0 asks for nothing."""
    assert rig.run(upload(rig.context, ()), Copter()) is Outcome.ACCEPTED


@pytest.mark.parametrize("lost", range(1, 11))
@pytest.mark.parametrize("direction", ["lose_in", "lose_out"])
def test_any_one_lost_frame_costs_less_than_the_vehicles_own_second(rig, direction, lost):
    """Whichever frame is lost, the mission arrives whole, or reading back has to decide."""
    copter = Copter(**{direction: frozenset([lost])})
    outcome = rig.run(upload(rig.context, ITEMS), copter)
    assert copter.held == list(range(9))
    assert rig.now_s < 1.0
    final_ack_lost = direction == "lose_out" and lost == 10
    assert outcome is (Outcome.UNCERTAIN if final_ack_lost else Outcome.ACCEPTED)


def test_invalid_sequence_is_not_failure(rig):
    """Code 13 answers each copy of an item; the upload stays open."""

    class Noisy(Copter):
        def react(self, message, now_s):
            yield ack(INVALID_SEQUENCE)
            yield from super().react(message, now_s)

    assert rig.run(upload(rig.context, ITEMS), Noisy()) is Outcome.ACCEPTED


def test_requests_of_the_int_form_are_answered_too(rig):
    """Other firmware asks with MISSION_REQUEST_INT."""

    class Modern(Copter):
        def react(self, message, now_s):
            for reply in super().react(message, now_s):
                old = reply.get_type() == "MISSION_REQUEST"
                form = mavlink.MAVLink_mission_request_int_message
                yield form(255, 191, reply.seq, 0) if old else reply

    assert rig.run(upload(rig.context, ITEMS), Modern()) is Outcome.ACCEPTED


@pytest.mark.parametrize("code", [UNSUPPORTED, 2, 5, 6, 9, 10, 11, 12])
def test_a_refused_item_is_named_with_the_reason(rig, code):
    """Every refusal code ends the upload at once, with the item at fault."""
    with pytest.raises(TransferError, match="at item 4") as caught:
        rig.run(upload(rig.context, ITEMS), Copter(refuse={4: code}))
    assert caught.value.code == 401
    assert rig.now_s < 1.0


def test_a_bad_jump_is_refused_though_its_code_could_mean_anything(rig):
    """DO_JUMP past the end earns ERROR, like items without an upload: tried again, then said."""
    with pytest.raises(TransferError, match="ERROR at item 4") as caught:
        rig.run(upload(rig.context, ITEMS), Copter(refuse={4: ERROR}))
    assert caught.value.code == 401


def test_too_many_items_are_refused_with_the_vehicles_words(rig):
    """NO_SPACE comes at once, with a text that says how many fit."""

    def small(message, now_s):
        yield 0.001, mavlink.MAVLink_statustext_message(4, b"Only 650 items are supported")
        yield REPLY_S, ack(NO_SPACE)

    with pytest.raises(TransferError, match="Only 650 items are supported"):
        rig.run(upload(rig.context, ITEMS), small)


def test_another_stations_upload_is_waited_for(rig):
    """DENIED until the other station's upload times out after 8 s, then it is our turn."""

    class Busy(Copter):
        def react(self, message, now_s):
            if now_s < 8.0 and self.expected is None:
                yield ack(DENIED)
            else:
                yield from super().react(message, now_s)

    assert rig.run(upload(rig.context, ITEMS), Busy()) is Outcome.ACCEPTED
    assert 8.0 < rig.now_s < 12.0
    assert any("another station" in report.text for report in rig.reports)
    assert len([t for t in rig.sent_types() if t == "MISSION_COUNT"]) < 12


def test_a_vehicle_held_by_another_station_for_good_is_given_up(rig):
    """After a minute, with the reason."""
    with pytest.raises(TransferError, match="another station") as caught:
        rig.run(upload(rig.context, ITEMS), lambda m, t: [(REPLY_S, ack(DENIED))])
    assert caught.value.code == 402
    assert rig.now_s < 70.0


def test_a_cancelled_upload_starts_over(rig):
    """Code 15 after the vehicle's 8 s: from item 0 again."""

    class Impatient(Copter):
        cancelled = False

        def react(self, message, now_s):
            if getattr(message, "seq", 0) == 5 and not self.cancelled:
                self.cancelled, self.expected = True, None
                yield ack(CANCELLED)
            else:
                yield from super().react(message, now_s)

    copter = Impatient()
    assert rig.run(upload(rig.context, ITEMS), copter) is Outcome.ACCEPTED
    assert copter.held == list(range(9))
    assert any("starts over" in report.text for report in rig.reports)


def test_a_reboot_in_mid_upload_starts_over(rig):
    """Five silent seconds, then the upload is unknown to the vehicle: ERROR, so announce again."""

    class Rebooting(Copter):
        down_s = None

        def react(self, message, now_s):
            if getattr(message, "seq", 0) == 5 and self.down_s is None:
                self.down_s, self.expected = now_s, None
            if self.down_s is not None and now_s < self.down_s + 5.0:
                return
            yield from super().react(message, now_s)

    copter = Rebooting()
    assert rig.run(upload(rig.context, ITEMS), copter) is Outcome.ACCEPTED
    assert copter.held == list(range(9))
    assert rig.now_s < 8.0


def test_a_dead_link_is_given_up(rig):
    """No answer at all: an error that says so, after half a minute of ever rarer tries."""
    with pytest.raises(TransferError) as caught:
        rig.run(upload(rig.context, ITEMS), lambda m, t: [])
    assert caught.value.code == 403
    assert 29.0 < rig.now_s < 40.0
    assert len(rig.sent) < 50


def test_a_link_that_dies_in_the_middle_is_given_up(rig):
    """Also when the vehicle had begun to ask."""
    copter = Copter(lose_in=frozenset(range(5, 10_000)))
    with pytest.raises(TransferError) as caught:
        rig.run(upload(rig.context, ITEMS), copter)
    assert caught.value.code == 403
    assert rig.now_s < 90.0


def test_a_slow_link_is_not_filled_with_copies(rig):
    """With 1.3 s each way the vehicle asks twice by itself; ours must not add many more."""

    class Slow(Copter):
        def __call__(self, message, now_s):
            for _, reply in super().__call__(message, now_s):
                yield 1.3, reply

    rig.context.round_trip.measure(1.3)
    assert rig.run(upload(rig.context, ITEMS), Slow()) is Outcome.ACCEPTED
    assert len(rig.sent) < 30


def test_answers_to_others_are_not_ours(rig):
    """Acknowledgements for another station, component or mission type change nothing."""

    class Crowded(Copter):
        def react(self, message, now_s):
            yield ack(UNSUPPORTED, system=254)
            yield ack(UNSUPPORTED, component=190)
            yield ack(UNSUPPORTED, kind=1)
            yield from super().react(message, now_s)

    assert rig.run(upload(rig.context, ITEMS), Crowded()) is Outcome.ACCEPTED


def test_an_early_acceptance_is_an_echo(rig):
    """ACCEPTED before the last item was sent belongs to an earlier transfer."""

    class Echo(Copter):
        def react(self, message, now_s):
            if message.get_type() == "MISSION_COUNT":
                yield ack(ACCEPTED)
            yield from super().react(message, now_s)

    copter = Echo()
    assert rig.run(upload(rig.context, ITEMS), copter) is Outcome.ACCEPTED
    assert copter.held == list(range(9))
