"""A flight held against its plan."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from jfto.analysis.facts import FlightFacts, facts_of
from jfto.analysis.grid import FINER, slot_starts
from jfto.analysis.record import AirLog, RecordedFlight
from jfto.pipeline.run import Run
from jfto.planning.survey import Survey
from jfto_msgs_py.records.event import ERROR, WARN, Event
from jfto_msgs_py.records.network import Adjacency, SlotHorizon
from support.fleets import START_NS
from support.flights import Flaws, recorded


class Desk:
    """The tiny scene's plan and what is held against it."""

    def __init__(self, run: Run, survey: Survey) -> None:
        assert run.comparison is not None
        self.plan, self.ours, self.dem = run.plan, run.comparison.ours, survey.dem

    def flight(self, *arguments: object) -> RecordedFlight:
        """A flight with flaws and events."""
        return recorded(self.plan, self.ours.power_w, *arguments)  # type: ignore[arg-type]

    def facts(self, flight: RecordedFlight, clearance_m: float = -1000.0) -> FlightFacts:
        """What comes of a flight."""
        return facts_of(flight, self.plan, self.ours, self.dem, n_dc=5, clearance_m=clearance_m)


@pytest.fixture(scope="module")
def desk(tiny_run: tuple[Path, Run], tiny_survey: Survey) -> Desk:
    """The tiny scene."""
    return Desk(tiny_run[1], tiny_survey)


@pytest.fixture(scope="module")
def as_planned(desk: Desk) -> FlightFacts:
    """A flight without flaws."""
    return desk.facts(desk.flight())


def test_a_flight_as_planned_is_clean(desk: Desk, as_planned: FlightFacts) -> None:
    """All waypoints on time, no exception, all landed."""
    assert as_planned.visited == 12
    assert abs(as_planned.worst_late_s) < 0.25
    assert as_planned.worst_closest_m < 1.5
    assert as_planned.certificate.exceptions == ()
    assert as_planned.certificate.clean_share == 1.0
    assert [one.how for one in as_planned.endings] == ["landed"] * 4
    assert as_planned.good
    assert as_planned.grid.slots == desk.plan.slots.count


def test_the_certificate_agrees_with_the_plans(desk: Desk, as_planned: FlightFacts) -> None:
    """On tracks as planned, margin and distance are those of the plan's own certificate."""
    planned = desk.plan.certificate
    assert planned is not None
    flown = as_planned.certificate
    assert flown.worst_margin_db == pytest.approx(planned.worst_margin_db, abs=0.05)
    assert flown.worst_margin_uav == planned.worst_margin_uav
    assert flown.least_separation_m == pytest.approx(planned.worst_separation_m, abs=0.05)
    assert (flown.slot_checks, flown.slot_violations) == (44, 0)


def test_a_uav_that_is_declared_lost_has_not_landed(desk: Desk) -> None:
    """The fleet's last word names how each flight ended, also that of a UAV nobody hears of."""
    ends = "The flight is over: uav2 landed on its pad; uav1 declared lost, last heard at 46.6 8.5."
    event = Event(WARN, "landed", "", ends, START_NS + 10**11, "mavlink_bridge")
    facts = desk.facts(desk.flight(Flaws(gone_s={"uav1": 10.0}), [event]))
    assert [one.how for one in facts.endings] == ["lost", "landed", "landed", "landed"]


def test_energy_is_the_sum_of_powers_in_force(desk: Desk, as_planned: FlightFacts) -> None:
    """Steps of power over the slots 0 … N - 1, by hand."""
    power, step = desk.ours.power_w, desk.plan.slots.duration_s
    for index, one in enumerate(as_planned.energy):
        assert one.used_j == pytest.approx(power[:-1, index].sum() * step, rel=1e-6)
        assert one.overdraft_j == 0.0


def test_late_uavs_are_late_at_every_waypoint(desk: Desk) -> None:
    """Four seconds late is that, but for the time between two poses, at fly-bys and at the stop."""
    facts = desk.facts(desk.flight(Flaws(late_s={"uav2": 4.0})))
    late = [one.late_s for one in facts.passages if one.uav == "uav2"]
    assert late == pytest.approx([4.0] * 4, abs=0.25)
    others = [one.late_s for one in facts.passages if one.uav != "uav2"]
    assert others == pytest.approx([0.0] * 8, abs=0.2)


def test_a_waypoint_passed_too_far_away_is_missed(desk: Desk) -> None:
    """Thirty metres higher is no visit, and the distance is said."""
    facts = desk.facts(desk.flight(Flaws(off_m={"uav4": (0.0, 0.0, 30.0)})))
    assert facts.visited == 8
    closest = [one.closest_m for one in facts.passages if one.uav == "uav4"]
    assert min(closest) > 10.0
    assert max(closest) < 31.0
    assert not facts.good


def test_a_uav_out_of_reach_is_an_exception_with_its_cause(desk: Desk) -> None:
    """30 km away, uav1 has no neighbours and the fleet is in two parts; the reason is said."""
    event = Event(
        ERROR, "gps", "uav1", "uav1 lost its position", START_NS + 10**9, "mavlink_bridge"
    )
    flaws = Flaws(off_m={"uav1": (30_000.0, 0.0, 0.0)})
    facts = desk.facts(desk.flight(flaws, [event]))
    kinds = {(one.kind, one.uav) for one in facts.certificate.exceptions}
    assert {("neighbours", "uav1"), ("connected", "")} <= kinds
    one = next(e for e in facts.certificate.exceptions if (e.kind, e.uav) == ("neighbours", "uav1"))
    assert (one.first_slot, one.value, one.limit) == (0.0, 0.0, 2.0)
    assert one.margin_db is not None
    assert one.margin_db < -20.0
    assert "uav1 lost its position (1 s)" in one.cause
    assert re.search(r"uav1 was 3000\d m from its planned place", one.cause)
    assert facts.certificate.clean_share == 0.0


def test_two_uavs_too_close_are_named_as_a_pair(desk: Desk) -> None:
    """Pads are 11 m apart; 5 m nearer, the two break d_min on the ground already."""
    pads = np.array([uav.start_m for uav in desk.plan.uavs])
    apart = np.linalg.norm(pads[:, None] - pads[None], axis=2) + 1e6 * np.eye(4)
    a, b = np.unravel_index(int(np.argmin(apart)), apart.shape)
    shift = 5.0 * (pads[b] - pads[a]) / apart[a, b]
    flaws = Flaws(off_m={f"uav{a + 1}": shift.tolist()})
    exceptions = desk.facts(desk.flight(flaws)).certificate.exceptions
    close = next(one for one in exceptions if one.kind == "separation")
    assert set(close.uav.split("+")) == {f"uav{a + 1}", f"uav{b + 1}"}
    assert close.value == pytest.approx(apart[a, b] - 5.0, abs=0.1)
    assert close.first_slot == 0.0


def test_a_lost_uav_is_an_exception_until_the_end(desk: Desk) -> None:
    """Silent for good after 50 s: lost from there on, its slots are not clean, others fly on."""
    facts = desk.facts(desk.flight(Flaws(gone_s={"uav4": 50.0})))
    lost = [one for one in facts.certificate.exceptions if one.kind == "lost"]
    assert [(one.uav, one.last_slot) for one in lost] == [("uav4", 10.0)]
    assert 53.0 <= lost[0].time_s <= 54.0
    assert facts.endings[3].how == "lost"
    assert not facts.certificate.clean[6:].any()
    assert facts.certificate.clean[:5].all()
    assert sum(one.visited for one in facts.passages if one.uav != "uav4") == 8


def test_a_gap_in_the_poses_is_told_and_bridged(desk: Desk) -> None:
    """Unheard for eight seconds, a UAV is still there: no link is held to be broken."""
    facts = desk.facts(desk.flight(Flaws(unheard_s={"uav3": (60.0, 68.0)})))
    assert [(one.kind, one.uav) for one in facts.certificate.exceptions] == [("seen", "uav3")]
    assert facts.certificate.exceptions[0].value == pytest.approx(7.0, abs=1.5)


def test_flying_below_the_clearance_is_an_exception(desk: Desk, as_planned: FlightFacts) -> None:
    """A clearance just above the least height away from the pads is broken, one below is not."""
    pads = np.array([uav.start_m for uav in desk.plan.uavs])
    away = np.linalg.norm((as_planned.grid.position_m - pads)[..., :2], axis=2) > 15.0
    least = float(as_planned.certificate.height_m[away].min())
    low = desk.facts(desk.flight(), clearance_m=least + 1.0).certificate.exceptions
    assert {one.kind for one in low} == {"height"}
    assert min(one.value for one in low) == pytest.approx(least)
    assert desk.facts(desk.flight(), clearance_m=least - 1.0).certificate.exceptions == ()


def test_throughput_and_links_are_of_the_powers_in_force(
    desk: Desk, as_planned: FlightFacts
) -> None:
    """Doubling every power keeps all planned links in mid-slot and carries at least the plan's."""
    from dataclasses import replace

    flight = desk.flight()
    powers = {
        uav: replace(steps, power_w=2 * steps.power_w) for uav, steps in flight.powers.items()
    }
    strong = desk.facts(replace(flight, powers=powers))
    assert strong.throughput.ratio > 1.0
    assert (strong.network.links >= desk.ours.linked.links).mean() > 0.99
    assert 0.5 < as_planned.throughput.ratio < 1.1
    assert [one.used_j for one in strong.energy] == pytest.approx(
        [2 * one.used_j for one in as_planned.energy]
    )


def test_the_airs_own_reports_count_before_the_model(desk: Desk) -> None:
    """Rate, energy and power are taken from the air where it reported: 10 Mb/s on every link."""
    from dataclasses import replace

    times = np.arange(0.0, desk.plan.slots.horizon_s + 10.0, 0.5)
    rate = np.full((len(times), 4, 4), 1e7)
    rate[:, range(4), range(4)] = 0.0
    flight = replace(
        desk.flight(),
        air={
            "rate": AirLog(times, rate),
            "power": AirLog(times, np.ones((len(times), 4))),
            "energy": AirLog(times, np.full((len(times), 4), 7.0) + times[:, None]),
        },
    )
    facts = desk.facts(flight)
    assert facts.network.throughput_bps == pytest.approx(np.full(11, 6e7))
    assert facts.network.hops == 1.0
    assert "simulated air" in facts.network.source
    assert [one.used_j for one in facts.energy] == pytest.approx([desk.plan.slots.horizon_s] * 4)


def test_energy_beyond_the_budget_is_an_exception(desk: Desk) -> None:
    """Ten watts for the whole mission is more than anybody has."""
    from dataclasses import replace

    flight = desk.flight()
    powers = {
        uav: replace(steps, power_w=0 * steps.power_w + 10) for uav, steps in flight.powers.items()
    }
    facts = desk.facts(replace(flight, powers=powers))
    energy = [one for one in facts.certificate.exceptions if one.kind == "energy"]
    assert [one.uav for one in energy] == ["uav1", "uav2", "uav3", "uav4"]
    assert energy[0].value == pytest.approx(10 * desk.plan.slots.horizon_s)
    assert not facts.good


def test_slots_begin_when_they_were_published_to(desk: Desk) -> None:
    """Slot 4 begins 3 s late, which shifts all after it; the last one, repeated, began once."""
    from dataclasses import replace

    step = desk.plan.slots.duration_s
    ids = tuple(uav.id for uav in desk.plan.uavs)
    links = np.zeros((1, 4, 4), dtype=np.bool_)

    def published(first: int, begin_s: float) -> Adjacency:
        horizon = SlotHorizon(first, START_NS + round(begin_s * 1e9), step, 1)
        return Adjacency(horizon, ids, links)

    said = (published(2, 2 * step), published(4, 4 * step + 3.0), published(10, 10 * step + 3.0))
    repeated = published(10, 12 * step)
    flight = replace(desk.flight(), adjacency=(*said, repeated))
    starts = slot_starts(flight, desk.plan, desk.plan.slots.horizon_s)
    late = starts - np.arange(len(starts)) * step
    assert late == pytest.approx([0.0, 0.0, 0.0, 1.5] + [3.0] * 7, abs=1e-6)


def test_a_fleet_that_is_late_flies_more_slots(desk: Desk) -> None:
    """Twelve seconds late with slots of 9.6 s by the clock: one more slot is looked at."""
    facts = desk.facts(desk.flight(Flaws(late_s={f"uav{k}": 12.0 for k in range(1, 5)})))
    assert facts.grid.slots == 11
    assert len(facts.certificate.clean) == 12
    assert len(facts.grid.times_s) == 11 * FINER + 1


def test_lateness_is_part_of_the_verdict(desk: Desk) -> None:
    """More than a slot late is not as planned, and clean slots are not called so without it."""
    slot_s = desk.plan.slots.duration_s
    uavs = [uav.id for uav in desk.plan.uavs]
    late = desk.facts(desk.flight(Flaws(late_s=dict.fromkeys(uavs, 1.2 * slot_s))))
    assert not late.good
    assert "but up to" in late.in_words()
    assert "s later than planned" in late.in_words()
    on_time = desk.facts(desk.flight())
    assert on_time.good
    assert "later than planned" not in on_time.in_words()


def test_a_record_that_ends_early_is_judged_up_to_there(desk: Desk) -> None:
    """The recorder died after 50 s: five slots, nobody lost, and the note says where it ends."""
    from dataclasses import replace

    flaws = Flaws(gone_s={f"uav{k}": 50.0 for k in range(1, 5)})
    facts = desk.facts(replace(desk.flight(flaws), complete=False))
    assert facts.grid.slots == 5
    assert facts.certificate.exceptions == ()
    assert "the record ends in slot 5 of 10" in facts.flight.notes
