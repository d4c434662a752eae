"""Several sorties: divided, planned, kept in files, and what one leaves is flown by the next."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jfto.cli.main import main
from jfto.pipeline.directory import FLIGHT_NAME, PLAN_NAME
from jfto.pipeline.sortie_run import with_left_over
from jfto.pipeline.sorties import left_over, save_sorties, sortie_directory, stale_sorties
from jfto.planning.scenario_file import LoadedScenario, load_scenario
from jfto.planning.sorties import PlannedSorties, faults_together, plan_sorties
from jfto.planning.survey import survey
from jfto_mavlink.mission.build import build_missions
from jfto_mavlink.mission.settings import settings_for
from jfto_msgs_py.errors import InfeasibleError, InputError
from jfto_msgs_py.plan_file import plan_text, read_plan, write_plan
from jfto_msgs_py.records.plan import Plan
from jfto_msgs_py.records.site import Sortie
from jfto_msgs_py.scenario.sorties import STARTS
from jfto_world.mission.steps import mission_items

TINY = Path(__file__).parents[2] / "data" / "scenario" / "tiny.yaml"
# Half of what the tiny scene takes.
SHORT = ["fleet.t_max_s=60"]


@pytest.fixture(name="short", scope="module")
def _short(tiny: Path) -> LoadedScenario:
    return load_scenario(tiny, SHORT)


@pytest.fixture(name="planned", scope="module")
def _planned(short: LoadedScenario) -> PlannedSorties:
    return plan_sorties(short.scenario, survey(short))


@pytest.fixture(name="plans")
def _plans(planned: PlannedSorties) -> tuple[Plan, ...]:
    return planned.plans


def test_every_waypoint_is_in_one_clean_sortie(short: LoadedScenario, planned) -> None:
    """Each is a certified plan of its own with its number; together they have all waypoints."""
    plans = planned.plans
    count = len(plans)
    assert count >= max(2, planned.least)
    assert [plan.sortie for plan in plans] == [Sortie(k + 1, count) for k in range(count)]
    assert all(plan.clean for plan in plans)
    ids = [waypoint.id for plan in plans for waypoint in plan.waypoints]
    assert sorted(ids) == [waypoint.id for waypoint in survey(short).waypoints]
    assert {plan.scenario_hash for plan in plans} == {short.scenario.scenario_hash()}


def test_the_same_seed_gives_the_same_bytes(short: LoadedScenario, plans) -> None:
    """Divisions, trials and searches have no chance in them but the seed."""
    again = plan_sorties(short.scenario, survey(short)).plans
    assert [plan_text(one) for one in again] == [plan_text(one) for one in plans]


@settings(max_examples=5, deadline=None, derandomize=True)
@given(st.integers(0, 500), st.integers(2, 14), st.integers(25, 110), st.sampled_from(STARTS))
def test_any_scene_is_divided_whole(seed: int, count: int, latest_s: int, starts: str) -> None:
    """Whatever the waypoints and the time: several sorties are clean and have each waypoint once;
    one alone is the whole scene, and says what it breaks.
    """
    drawn = [f"waypoints.seed={seed}", f"waypoints.count={count}", f"sorties.starts={starts}"]
    loaded = load_scenario(TINY, [*drawn, f"fleet.t_max_s={latest_s}"])
    found = survey(loaded)
    plans = plan_sorties(loaded.scenario, found).plans
    ids = sorted(waypoint.id for plan in plans for waypoint in plan.waypoints)
    assert ids == [waypoint.id for waypoint in found.waypoints]
    assert len(plans) == 1 or all(plan.clean for plan in plans)
    assert all(plan.certificate is not None for plan in plans)
    assert faults_together(plans) == ()


def test_one_flight_stays_one_plan(tiny: Path, tiny_survey) -> None:
    """A scene that one flight does is planned as ever, and says sortie 1 of 1."""
    (plan,) = plan_sorties(load_scenario(tiny).scenario, tiny_survey).plans
    assert (plan.clean, plan.sortie) == (True, Sortie(1, 1))


def test_a_number_that_is_asked_for_is_kept_or_refused(tiny: Path, tiny_survey) -> None:
    """Three where one would do; two where two do not, with the reason."""
    three = plan_sorties(load_scenario(tiny, ["sorties.count=3"]).scenario, tiny_survey)
    assert len(three.plans) == 3
    tight = load_scenario(tiny, ["sorties.count=2", "fleet.t_max_s=25"])
    with pytest.raises(InfeasibleError, match=r"sorties\.count is 2, but no division was found"):
        plan_sorties(tight.scenario, tiny_survey)


def test_sorties_begin_where_they_are_told_to(tiny: Path, tiny_survey) -> None:
    """The nearest of sorties.positions_m; the same places for all where that is asked."""
    places = ["sorties.count=2", "sorties.positions_m=-100,-100,100,100"]
    plans = plan_sorties(load_scenario(tiny, places).scenario, tiny_survey).plans
    middles = [tuple(round(sum(u.start_m[k] for u in p.uavs) / 4) for k in (0, 1)) for p in plans]
    assert set(middles) <= {(-100, -100), (100, 100)}
    alike = ["sorties.count=2", "sorties.starts=same"]
    first, second = plan_sorties(load_scenario(tiny, alike).scenario, tiny_survey).plans
    assert [uav.start_m for uav in first.uavs] == [uav.start_m for uav in second.uavs]


def test_plans_of_another_place_are_nobodys_to_remove(plans, tmp_path: Path) -> None:
    """Only what an earlier division of the same place left, under the number in its name."""
    last, origin = plans[-1], plans[-1].origin
    number = len(plans) + 1
    write_plan(replace(last, sortie=Sortie(number, number)), tmp_path / f"p-{number}.json")
    elsewhere = replace(origin, lat_deg=origin.lat_deg + 0.5)
    other = replace(last, origin=elsewhere, sortie=Sortie(number + 1, number + 1))
    write_plan(other, tmp_path / f"p-{number + 1}.json")
    (tmp_path / f"p-{number + 2}.json").write_text("{}")
    assert stale_sorties(tmp_path / "p.json", plans) == (tmp_path / f"p-{number}.json",)


def test_files_are_written_all_or_none_and_old_ones_go(plans, tmp_path: Path) -> None:
    """A shorter division removes plans of a longer one, and nothing of anybody else."""
    path = tmp_path / "plan.json"
    nobody = replace(plans[0], sortie=Sortie(1, 1))
    write_plan(replace(plans[0], sortie=Sortie(8, 9)), tmp_path / "plan-8.json")
    write_plan(nobody, tmp_path / "plan-9.json")
    (tmp_path / "plan-10.json").write_text("{}")
    files = save_sorties(plans, path)
    assert [file.name for file in files] == [f"plan-{k + 1}.json" for k in range(len(plans))]
    others = {"plan-9.json", "plan-10.json"}
    assert {file.name for file in tmp_path.iterdir()} == {file.name for file in files} | others
    (tmp_path / "there" / "plan-2.json").mkdir(parents=True)
    with pytest.raises(InputError, match=r"plan-2\.json: cannot be written"):
        save_sorties(plans, tmp_path / "there" / "plan.json")
    assert [file.name for file in (tmp_path / "there").iterdir()] == ["plan-2.json"]


def _flown(directory: Path, plan: Plan, missed: set[int]) -> None:
    """The record of a flight that missed some waypoints."""
    folder = sortie_directory(directory, plan.sortie.number)
    folder.mkdir(parents=True)
    write_plan(plan, folder / PLAN_NAME)
    passages = [
        {"waypoint": one.id, "closest_m": None if one.id in missed else 0.4}
        for one in plan.waypoints
    ]
    text = json.dumps({"waypoints": {"passages": passages}})
    (folder / FLIGHT_NAME).write_text(text)


def test_what_a_sortie_leaves_is_added_to_the_next(short: LoadedScenario, plans, tmp_path) -> None:
    """The next one is planned anew with it; once visited it is left no more."""
    missed = plans[0].waypoints[0].id
    _flown(tmp_path, plans[0], {missed})
    assert {k: [w.id for w in some] for k, some in left_over(tmp_path, 2).items()} == {1: [missed]}
    roomy = replace(short, scenario=load_scenario(short.path).scenario)
    plan = with_left_over(roomy, tmp_path, plans, 2)
    assert plan.clean
    wanted = {missed, *(waypoint.id for waypoint in plans[1].waypoints)}
    assert {waypoint.id for waypoint in plan.waypoints} == wanted
    assert plan.sortie == plans[1].sortie
    starts = [[uav.start_m[:2] for uav in one.uavs] for one in (plan, plans[1])]
    assert starts[0] == starts[1]
    _flown(tmp_path, plan, set())
    assert left_over(tmp_path, 3) == {}


def test_what_fits_nowhere_is_flown_by_one_more(short: LoadedScenario, plans, tmp_path) -> None:
    """After the last sortie there is one more for what is left, and none where nothing is."""
    last = plans[-1]
    more = len(plans) + 1
    with pytest.raises(InputError, match=f"--sortie {more}: there are .* none has left"):
        with_left_over(short, tmp_path, plans, more)
    missed = {last.waypoints[0].id, last.waypoints[1].id}
    _flown(tmp_path, last, missed)
    plan = with_left_over(short, tmp_path, plans, more)
    assert (plan.clean, plan.sortie) == (True, Sortie(more, more))
    assert {waypoint.id for waypoint in plan.waypoints} == missed


def test_a_sortie_that_is_full_stays_as_it_is(short: LoadedScenario, plans, tmp_path) -> None:
    """All of another sortie does not fit: it is said to wait, and the plan is untouched."""
    everything = {waypoint.id for waypoint in plans[0].waypoints}
    _flown(tmp_path, plans[0], everything)
    tight = replace(short.scenario.fleet, t_max_s=(5.0,) * 4)
    loaded = replace(short, scenario=replace(short.scenario, fleet=tight))
    assert plan_text(with_left_over(loaded, tmp_path, plans, 2)) == plan_text(plans[1])


def test_the_command_says_how_many(
    tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Sorties, UAVs, minutes, the bound, and each file; check takes them together."""
    path = tmp_path / "plan.json"
    assert main(["plan", str(tiny), "--set", SHORT[0], "-o", str(path)]) == 0
    said = capsys.readouterr().out
    files = sorted(map(str, tmp_path.glob("plan-*.json")))
    assert f"{len(files)} sorties, 4 UAVs, " in said
    assert "min each (at least " in said
    assert all(file in said for file in files)
    assert not path.exists()
    assert main(["check", *files]) == 0
    assert "each of 12 waypoints in one" in capsys.readouterr().out
    assert main(["check", files[0], *files]) == 3
    assert "sortie 1 is given twice" in capsys.readouterr().out
    assert main(["check", files[1]]) == 0
    assert read_plan(files[1]).sortie.number == 2


def test_missions_that_hold_little_make_sorties(tiny: Path, tiny_survey) -> None:
    """What no division over the fleet fits into missions is divided over flights."""
    overrides = ["fleet.mission_items=25", "fleet.t_max_s=450", "fleet.count=2"]
    fleet = ["fleet.p_max_dbm=30", "fleet.energy_j=200", "network.k_min=1"]
    scenario = load_scenario(tiny, overrides + fleet).scenario
    plans = plan_sorties(scenario, tiny_survey).plans
    assert len(plans) > 1
    for plan in plans:
        assert plan.clean
        assert max(mission_items(plan, a) for a in range(2)) <= 25
        assert all(len(one.mission.items) <= 25 for one in build_missions(plan, settings_for(plan)))
    assert sum(len(plan.waypoints) for plan in plans) == len(tiny_survey.waypoints)


def test_a_run_has_a_directory_for_each_sortie(
    tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Plans, figures and report of each; what was made is kept; the next one is named."""
    out = tmp_path / "run"
    wanted = [str(tiny), "--set", "sorties.count=2", "-o", str(out), "--until", "plan"]
    assert main(["run", *wanted]) == 0
    assert (
        f"Sortie      1 of 2; next: jfto run {tiny} -o {out} --sortie 2" in capsys.readouterr().out
    )
    for number in (1, 2):
        folder = out / f"sortie-{number}"
        assert read_plan(folder / "plan.json").sortie == Sortie(number, 2)
        assert (out / f"plan-{number}.json").read_bytes() == (folder / "plan.json").read_bytes()
        assert (folder / "report.html").exists()
        assert (folder / "figures" / "routes.png").exists()
    made = (out / "sortie-2" / "report.html").stat().st_mtime_ns
    assert main(["run", *wanted, "--sortie", "2"]) == 0
    assert "Sortie      2 of 2\n" in capsys.readouterr().out
    assert (out / "sortie-2" / "report.html").stat().st_mtime_ns == made
    assert main(["run", *wanted, "--sortie", "3"]) == 2
    assert "--sortie 3: there are 2, and none has left a waypoint" in capsys.readouterr().err
