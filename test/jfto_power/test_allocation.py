"""The exact allocation against the optimality conditions, a general solver and hand-made cases."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import InfeasibleError, InputError
from jfto_msgs_py.records.radio import Radio
from jfto_power.allocation import PowerProblem, allocate, allocate_prefix
from jfto_power.kkt import kkt_residual, objective_bps
from jfto_power.reference import ReferenceAllocator
from jfto_power.shortage import EnergyShortage
from jfto_world.radio import noise_w

READINGS = ("total", "per_hertz")
SLOT_S = 2.5


def instance(rng, reading, uavs=5, slots=24):
    """A random fleet: gains and intervals of the paper's size, with the odd cases mixed in."""
    radio = Radio(noise_reading=reading)
    gain = 10 ** rng.uniform(-10, -6, (slots + 1, uavs, uavs))
    gain = np.sqrt(gain * gain.transpose(0, 2, 1))
    linked = np.triu(rng.random((slots + 1, uavs, uavs)) < 0.5, 1)
    linked |= linked.transpose(0, 2, 1)
    linked[rng.integers(slots + 1)] = False
    low = rng.uniform(0, 0.5, (slots + 1, uavs)) * (rng.random((slots + 1, uavs)) < 0.9)
    high = low + rng.uniform(0, 0.5, low.shape) * (rng.random(low.shape) < 0.9)
    floor = low[1:].sum(axis=0)
    share = rng.choice([0.0, 0.01, 0.3, 0.7, 0.999, 1.0, 1.5], uavs)
    energy = (floor + share * (high[1:].sum(axis=0) - floor)) * SLOT_S
    return linked, gain, low, high, energy, SLOT_S, radio


@pytest.mark.parametrize("reading", READINGS)
@pytest.mark.parametrize("seed", range(5))
def test_optimum_equals_the_general_solver_and_meets_the_conditions(reading, seed):
    """20 instances a time, 100 per SNR reading: objective within 1e-6, KKT residual within 1e-8."""
    rng = np.random.default_rng(seed)
    reference = ReferenceAllocator()
    for _ in range(20):
        case = instance(rng, reading, uavs=3, slots=12)
        best = allocate(PowerProblem(*case))
        assert kkt_residual(PowerProblem(*case), best.power_w, best.multiplier) <= 1e-8
        linked, gain, radio = case[0], case[1], case[6]
        exact = objective_bps(linked, gain, best.power_w, radio)
        general = objective_bps(linked, gain, reference.solve(PowerProblem(*case)), radio)
        assert exact == pytest.approx(general, rel=1e-6)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.integers(0, 2**32 - 1), st.sampled_from(READINGS))
def test_powers_keep_to_their_intervals_and_budgets(seed, reading):
    """Whatever the instance, no bound is passed, no budget overdrawn, and nothing can be gained."""
    rng = np.random.default_rng(seed)
    case = instance(rng, reading, uavs=4, slots=int(rng.integers(1, 40)))
    _, _, low, high, energy, slot_s, _ = case
    best = allocate(PowerProblem(*case))
    assert (low <= best.power_w).all()
    assert (best.power_w <= high).all()
    assert (best.energy_j <= energy * (1 + 1e-12)).all()
    assert best.energy_j == pytest.approx(best.power_w[1:].sum(axis=0) * slot_s)
    assert kkt_residual(PowerProblem(*case), best.power_w, best.multiplier) <= 1e-8
    assert best.slots_held == len(low) - 1


def test_equal_links_share_the_budget_equally():
    """Slots of the same gain get the same power; a joule more is worth B / ln 2 / Δt / (p + s)."""
    radio = Radio()
    linked = np.ones((3, 1, 1), dtype=bool)
    gain = np.full((3, 1, 1), 1e-9)
    low, high = np.zeros((3, 1)), np.ones((3, 1))
    best = allocate(PowerProblem(linked, gain, low, high, [2 * 0.25 * SLOT_S], SLOT_S, radio))
    assert best.power_w[:, 0] == pytest.approx([0.25, 0.25, 0.25])
    worth = radio.bandwidth_hz / np.log(2) / SLOT_S / (0.25 + noise_w(radio) / 1e-9)
    assert best.multiplier[0] == pytest.approx(worth)


def test_water_filling_by_hand():
    """Noise worth 0.1 and 0.3 W at the sender is filled to one level: 0.35 + 0.1 = 0.15 + 0.3."""
    radio = Radio()
    gain = noise_w(radio) / np.array([1.0, 0.1, 0.3]).reshape(3, 1, 1)
    linked = np.ones((3, 1, 1), dtype=bool)
    best = allocate(
        PowerProblem(linked, gain, np.zeros((3, 1)), np.ones((3, 1)), [0.5], 1.0, radio)
    )
    assert best.power_w[1:, 0] == pytest.approx([0.35, 0.15])


def test_two_neighbours_pull_harder_than_one():
    """At high SNR a slot's power is proportional to its number of neighbours."""
    linked = np.array([[[1, 1]], [[1, 1]], [[1, 0]]], dtype=bool)
    gain = np.full((3, 1, 2), 1e-5)
    best = allocate(
        PowerProblem(linked, gain, np.zeros((3, 1)), np.ones((3, 1)), [0.3], 1.0, Radio())
    )
    assert best.power_w[1:, 0] == pytest.approx([0.2, 0.1], rel=1e-4)


def test_slot_zero_follows_the_level_without_paying():
    """Slot 0 is free: it gets what a slot like it gets, and the budget goes to the rest."""
    linked = np.ones((4, 1, 1), dtype=bool)
    gain = np.full((4, 1, 1), 1e-8)
    best = allocate(
        PowerProblem(linked, gain, np.zeros((4, 1)), np.ones((4, 1)), [0.6], 1.0, Radio())
    )
    assert best.power_w[:, 0] == pytest.approx([0.2] * 4)
    assert best.energy_j[0] == pytest.approx(0.6)


def test_slack_budget_means_full_power_and_no_price():
    """Where energy does not bind, powers are at their upper bounds and a joule is worth nothing."""
    linked = ~np.eye(2, dtype=bool)[None].repeat(3, axis=0)
    gain = np.full((3, 2, 2), 1e-8)
    low, high = np.full((3, 2), 0.1), np.full((3, 2), 0.4)
    best = allocate(PowerProblem(linked, gain, low, high, [10.0, 0.5], 1.0, Radio()))
    assert best.power_w[:, 0] == pytest.approx([0.4] * 3)
    assert best.multiplier[0] == 0
    assert best.multiplier[1] > 0


def test_slots_without_links_take_the_least_power():
    """A slot without neighbours has no rate to gain; its energy goes to the others."""
    linked = np.array([[[1]], [[0]], [[1]]], dtype=bool)
    gain = np.full((3, 1, 1), 1e-8)
    best = allocate(
        PowerProblem(linked, gain, np.full((3, 1), 0.1), np.ones((3, 1)), [0.7], 1.0, Radio())
    )
    assert best.power_w[1:, 0] == pytest.approx([0.1, 0.6])


@pytest.mark.parametrize("reading", READINGS)
def test_budget_equal_to_the_floor_leaves_the_floor(reading):
    """Energy exactly Σ P_min Δt is feasible, with one allocation: P_min."""
    linked, gain, low, high, _, slot_s, radio = instance(np.random.default_rng(3), reading)
    floor = low[1:].sum(axis=0) * slot_s
    best = allocate(PowerProblem(linked, gain, low, high, floor, slot_s, radio))
    assert best.power_w[1:] == pytest.approx(low[1:])


def test_zero_budget_needs_zero_floor():
    """No energy at all is enough when nothing has to be sent, and only then."""
    linked, gain = np.ones((3, 1, 1), dtype=bool), np.full((3, 1, 1), 1e-8)
    silent = allocate(
        PowerProblem(linked, gain, np.zeros((3, 1)), np.ones((3, 1)), [0.0], 1.0, Radio())
    )
    assert silent.power_w[1:].tolist() == [[0.0], [0.0]]
    with pytest.raises(EnergyShortage):
        allocate(
            PowerProblem(linked, gain, np.full((3, 1), 1e-6), np.ones((3, 1)), [0.0], 1.0, Radio())
        )


def test_one_row_aboard_equals_the_fleet_at_the_desk():
    """A UAV that knows only its own row finds the powers that the whole problem gives it."""
    linked, gain, low, high, energy, slot_s, radio = instance(np.random.default_rng(8), "total")
    fleet = allocate(PowerProblem(linked, gain, low, high, energy, slot_s, radio))
    for a in range(len(energy)):
        row = slice(a, a + 1)
        own = (linked[:, row], gain[:, row], low[:, row], high[:, row], energy[row])
        alone = allocate(PowerProblem(*own, slot_s, radio))
        assert np.array_equal(alone.power_w[:, 0], fleet.power_w[:, a])


def test_plan_of_slot_zero_alone():
    """A plan without a slot that costs energy is at full power."""
    linked, gain = np.ones((1, 1, 1), dtype=bool), np.full((1, 1, 1), 1e-8)
    best = allocate(
        PowerProblem(linked, gain, np.zeros((1, 1)), np.ones((1, 1)), [0.0], 1.0, Radio())
    )
    assert best.power_w.tolist() == [[1.0]]


def shortage_case():
    """UAV 1 holds two of three slots, UAV 2 all, UAV 3 none."""
    low = np.array([[9.0, 0, 9], [0.2, 0.1, 1], [0.2, 0.1, 1], [0.2, 0.1, 1]])
    linked = ~np.eye(3, dtype=bool)[None].repeat(4, axis=0)
    linked[:, [0, 1, 2], [0, 1, 2]] = False
    gain = np.full((4, 3, 3), 1e-8)
    return linked, gain, low, low + 0.5, np.array([0.5, 9.0, 0.9]), 1.0, Radio()


def test_shortage_names_uavs_joules_and_slots():
    """Too little energy says who, by how much, and how far it lasts."""
    with pytest.raises(EnergyShortage, match=r"alpha lacks 0\.1 J and holds 2 slots") as caught:
        allocate(PowerProblem(*shortage_case(), ("alpha", "bravo", "charlie")))
    shortage = caught.value
    assert isinstance(shortage, InfeasibleError)
    assert shortage.uavs == (0, 2)
    assert shortage.missing_j == pytest.approx([0.1, 2.1])
    assert shortage.held_slots.tolist() == [2, 0]
    assert shortage.prefix_slots == 0
    assert shortage.cures


def test_prefix_gets_the_best_allocation_and_nothing_after():
    """With UAV 3 funded for one slot the fleet holds slots 0 and 1, at the optimum for those."""
    linked, gain, low, high, energy, slot_s, radio = shortage_case()
    energy[2] = 1.2
    held = allocate_prefix(PowerProblem(linked, gain, low, high, energy, slot_s, radio))
    assert held.slots_held == 1
    shorter = allocate(PowerProblem(linked[:2], gain[:2], low[:2], high[:2], energy, slot_s, radio))
    assert np.array_equal(held.power_w[:2], shorter.power_w)
    assert not held.power_w[2:].any()
    assert held.energy_j[2] == pytest.approx(1.2)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({0: np.ones((3, 3), dtype=bool)}, "adjacency has shape"),
        ({1: np.ones((4, 3, 2))}, "and gain"),
        ({1: np.full((4, 3, 3), np.nan)}, "gain holds values"),
        ({0: np.ones((4, 3, 3), dtype=bool)}, "links UAV 0 to itself in slot 0; clear the diag"),
        ({2: np.ones((3, 3))}, "p_low_w has shape"),
        ({2: np.full((4, 3), 2.0), 3: np.full((4, 3), 1.0)}, "UAV 0 in slot 0"),
        ({2: np.full((4, 3), np.nan)}, "UAV 0 in slot 0"),
        ({4: np.ones(2)}, "energy_j has shape"),
        ({4: np.array([1.0, -1.0, 1.0])}, "must be joules from 0"),
        ({5: 0.0}, "slot_duration_s is 0.0"),
        ({6: None}, "radio is None"),
    ],
)
def test_contradicting_arguments_are_refused(change, message):
    """What does not fit together is named, with what it should be."""
    case = list(shortage_case())
    for place, value in change.items():
        case[place] = value
    with pytest.raises(InputError, match=message):
        allocate(PowerProblem(*case))


def test_names_are_one_for_each():
    """A name too few would label another UAV's shortage."""
    with pytest.raises(InputError, match="names has 2 entries for 3 UAVs"):
        PowerProblem(*shortage_case(), names=("a", "b"))
