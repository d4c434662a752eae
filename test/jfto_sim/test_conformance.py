"""The simulator answers the station's half of each recording as the real ArduCopter did."""

from collections import Counter
from pathlib import Path

import pytest

from support.conformance import compare, read_recording, replay
from support.conformance.compare import ANSWERS

DATA = Path(__file__).parents[1] / "data" / "ardupilot"
LEAST_SHARE = 0.95
RECORDINGS = (
    "01_connect_params",
    "02_mission_upload_ok",
    "02b_mission_item_forms",
    "03_mission_errors",
    "04_arming",
    "05_flight_guided_auto_rtl",
    "06_streams_and_failsafes",
    "07_signing_port",
    "08_three_vehicles",
    "09_auto_start_variants",
    "10_lossy_link_and_two_stations",
    "11_restart_resume_sysid",
    "12_motion_8wp_10ms",
    "13_motion_stop_legs",
    "14_fence_gps_motor",
    "15_mavlink1",
)
# Flown by JFTO itself over other ground; what the vehicles had been given beforehand.
FLOWN = {
    "20_flown_ceiling": {"FENCE_ENABLE": 1.0},
    "21_flown_wind": {"SIM_WIND_SPD": 8.0, "SIM_WIND_DIR": 270.0},
}
# A mission of 260 s; calm ones end within a second.
LATE_IN_WIND_S = 6.0


@pytest.mark.slow
@pytest.mark.parametrize("name", RECORDINGS)
def test_recording_is_answered_alike(name):
    """At least 95 % of a recording's answers come from the simulator too: type, codes, order."""
    paths = sorted(p for p in DATA.iterdir() if p.name.startswith(name) and ".tlog" in p.name)
    score = compare(name, *replay(read_recording(*paths)))
    missed = Counter(a.message.get_type() for a in score.missed if a.message.get_type() in ANSWERS)
    print(f"{name}: {score.share:.1%} of {score.answers} answers, missed {dict(missed)}")
    assert score.answers > 50
    assert score.share >= LEAST_SHARE, missed


def test_a_silent_vehicle_scores_nothing():
    """The measure itself notices a vehicle that says nothing."""
    recorded, _ = replay(read_recording(DATA / "02b_mission_item_forms.tlog"))
    score = compare("silence", recorded, [])
    assert score.share == 0.0
    assert score.answers == sum(a.message.get_type() in ANSWERS for a in recorded)


def test_wrong_codes_do_not_match():
    """An answer with another code is a miss, not a match."""
    recorded, simulated = replay(read_recording(DATA / "02b_mission_item_forms.tlog"))
    for a in simulated:
        if a.message.get_type() == "MISSION_ACK":
            a.message.type = 9
    score = compare("wrong", recorded, simulated)
    acks = sum(a.message.get_type() == "MISSION_ACK" for a in recorded)
    assert sum(a.message.get_type() == "MISSION_ACK" for a in score.missed) == acks


def flown(name):
    return replay(read_recording(DATA / f"{name}.tlog.xz"), FLOWN[name])


def test_a_ceiling_under_a_mission_ends_it_as_recorded():
    """Checks before there is a position, breach and way home: texts, codes and times."""
    score = compare("20_flown_ceiling", *flown("20_flown_ceiling"))
    missed = [str(a.message) for a in score.missed if a.message.get_type() in ANSWERS]
    assert score.share >= LEAST_SHARE, missed


def test_a_mission_in_wind_is_as_late_as_recorded():
    """8 m/s across and against it: every waypoint within 6 s of the real one's."""
    recorded, simulated = (
        {
            a.message.text: a.time_s
            for a in side
            if a.message.get_type() == "STATUSTEXT" and a.message.text.startswith("Reached")
        }
        for side in flown("21_flown_wind")
    )
    assert len(recorded) > 10
    assert set(recorded) <= set(simulated)
    late = {text: simulated[text] - recorded[text] for text in recorded}
    assert max(map(abs, late.values())) < LATE_IN_WIND_S, late
