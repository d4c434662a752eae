"""Rules that turn given values into a scenario."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto_msgs_py.errors import ScenarioError
from jfto_msgs_py.scenario import KEYS, PARTS, Given, Key, Scenario, make_scenario
from jfto_msgs_py.scenario.document import page
from jfto_msgs_py.scenario.value import in_range


def _layer(**values: object) -> dict[str, Given]:
    return {name.replace("__", "."): Given(value, "here") for name, value in values.items()}


def test_no_values_give_the_defaults() -> None:
    """An empty scenario is valid, and resolves per-UAV keys to one entry per UAV."""
    scenario = make_scenario([])
    assert scenario.fleet.ids == tuple(f"uav{number}" for number in range(1, 9))
    assert scenario.fleet.p_max_dbm == (30.0,) * 8
    assert scenario.radio == Scenario().radio


def test_a_later_layer_wins() -> None:
    """The command line overrides a node's values, and these the shared ones."""
    layers = [_layer(network__k_min=1), _layer(network__k_min=2), _layer(network__k_min=3)]
    assert make_scenario(layers).network.k_min == 3


def test_one_value_stands_for_all_uavs() -> None:
    """A number and a one-entry array mean the same for a per-UAV key."""
    for value in (27, 27.0, [27], [27.0]):
        fleet = make_scenario([_layer(fleet__count=3, fleet__p_max_dbm=value)]).fleet
        assert fleet.p_max_dbm == (27.0, 27.0, 27.0)


def test_the_antenna_short_hand_sets_both_gains() -> None:
    """radio.antenna_gain_dbi sets both ends, also over a file that gives them one by one."""
    file = _layer(radio__gain_tx_dbi=3.0, radio__gain_rx_dbi=5.0)
    radio = make_scenario([file, _layer(radio__antenna_gain_dbi=0)]).radio
    assert (radio.gain_tx_dbi, radio.gain_rx_dbi) == (0.0, 0.0)


def test_every_problem_is_listed() -> None:
    """One error carries all problems, each with its origin."""
    with pytest.raises(ScenarioError) as caught:
        make_scenario([_layer(network__k_min=-1, radio__noise_dbm=50.0, nonsense=1)])
    assert len(caught.value.problems) == 3
    assert all(problem.startswith("here: ") for problem in caught.value.problems)


def test_the_hash_follows_decisive_keys_only() -> None:
    """Seed and workers leave the hash alone; what changes a plan changes it."""
    hash_of = make_scenario([]).scenario_hash()
    same = make_scenario([_layer(search__seed=5, search__workers=3)])
    other = make_scenario([_layer(network__delta=1)])
    assert same.scenario_hash() == hash_of
    assert other.scenario_hash() != hash_of


def test_keys_that_came_later_leave_the_hash_of_older_scenarios_alone() -> None:
    """At their defaults they do not count, for any fleet; given, they do."""
    known = make_scenario([_layer(fleet__count=2, network__k_min=1)])
    said = {name: KEYS[name] for name in ("fleet.battery_wh", "fleet.battery_reserve_percent")}
    assert all(key.later for key in said.values())
    same = _layer(fleet__count=2, network__k_min=1, fleet__battery_wh=[0.0, 0.0])
    assert make_scenario([same]).scenario_hash() == known.scenario_hash()
    other = _layer(fleet__count=2, network__k_min=1, fleet__hover_power_w=200.0)
    assert make_scenario([other]).scenario_hash() != known.scenario_hash()


def test_a_battery_gives_the_latest_arrival_where_nobody_does() -> None:
    """0 means so; a given one stays; a battery without powers, or 0 without a battery, is wrong."""
    battery = {"fleet__battery_wh": 90.0, "fleet__hover_power_w": 300.0}
    assert set(make_scenario([_layer(**battery)]).fleet.t_max_s) == {0.0}
    given = _layer(**battery, fleet__t_max_s=500.0)
    assert set(make_scenario([given]).fleet.t_max_s) == {500.0}
    with pytest.raises(ScenarioError, match=r"battery_wh is given without fleet.hover_power_w"):
        make_scenario([_layer(fleet__battery_wh=90.0)])
    with pytest.raises(ScenarioError, match=r"t_max_s is 0, which is as late as the battery"):
        make_scenario([_layer(fleet__t_max_s=0.0)])


def test_missions_hold_for_whole_seconds() -> None:
    """ArduCopter keeps no fractions; curves do."""
    with pytest.raises(ScenarioError, match=r"trajectory.hold_s is 1.5.*Set it to 2"):
        make_scenario([_layer(trajectory__hold_s=1.5)])
    curves = make_scenario([_layer(trajectory__hold_s=1.5, trajectory__mode="guided")])
    assert curves.trajectory.hold_s == 1.5


def test_a_short_mission_takes_default_slots_along() -> None:
    """n_DC and the slot shown move to the last slot unless they were asked for."""
    evaluation = make_scenario([_layer(mission__slot_count=10)]).evaluation
    assert (evaluation.n_dc, evaluation.slot_shown) == (10, 10)


def test_keys_describe_the_parts_they_come_from() -> None:
    """Each key has a meaning, defaults lie inside ranges, and parts match the scenario's fields."""
    assert list(PARTS) == [field.name for field in dataclasses.fields(Scenario)]
    for key in KEYS.values():
        assert key.doc.endswith((".", '"'))
        for value in key.default if key.array else [key.default]:
            if key.kind in {"int", "float"}:
                assert in_range(key, value), key.name
            if key.choices:
                assert value in key.choices


def test_the_documentation_is_printed_from_the_schema() -> None:
    """docs/reference/scenario.md is what `python -m jfto_msgs_py.scenario.document` prints."""
    written = Path(__file__).parents[3] / "docs/reference/scenario.md"
    assert written.read_text(encoding="utf-8") == page()


_NUMERIC = [key for key in KEYS.values() if key.kind == "float" and not key.array]


def _is_tied(key: Key) -> bool:
    """Whether values must suit other keys too: one another's pitch, the mission's seconds."""
    return "pitch" in key.name or key.name in ("trajectory.hold_s", "area.buffer_m")


@settings(deadline=None, max_examples=150, derandomize=True)
@given(st.sampled_from(_NUMERIC), st.floats(allow_nan=True, allow_infinity=True))
def test_a_number_is_taken_or_refused_by_name(key: Key, value: float) -> None:
    """Any number is either inside the range and taken as it is, or refused with its key named."""
    layer = {key.name: Given(value, "here")}
    if math.isfinite(value) and in_range(key, value) and not _is_tied(key):
        assert make_scenario([layer]).values()[key.name] == value
    elif not math.isfinite(value) or not in_range(key, value):
        with pytest.raises(ScenarioError, match=key.name):
            make_scenario([layer])


@settings(deadline=None, max_examples=150, derandomize=True)
@given(
    st.dictionaries(
        st.sampled_from(sorted(KEYS)),
        st.recursive(
            st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
            lambda inner: st.lists(inner, max_size=3),
            max_leaves=4,
        ),
        max_size=5,
    )
)
def test_nonsense_never_gets_through_as_another_error(values: dict[str, object]) -> None:
    """Whatever values a file holds, the answer is a scenario or a ScenarioError."""
    layer = {name: Given(value, "here") for name, value in values.items()}
    problems: list[str] = []
    try:
        make_scenario([layer])
    except ScenarioError as error:
        problems = error.problems
    assert all(problem.startswith(("here: ", "scenario: ")) for problem in problems)
