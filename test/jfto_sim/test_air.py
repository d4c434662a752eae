"""The air: links from powers, energy, errors, broken radios."""

import numpy as np
import pytest

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.radio import Radio
from jfto_msgs_py.units import dbm_to_w
from jfto_sim.air import Air, AirMember, AirSettings

RADIO = Radio()
# Free space at 2.44 GHz with 3 + 3 dBi loses 94.19 dB over 1 km: 27 dBm arrive with -67.19 dBm.
LINE = np.array([[0.0, 0.0, 100.0], [1000.0, 0.0, 100.0], [2000.0, 0.0, 100.0]])


def air(settings=None, energy_j=100.0, ground=None):
    members = [AirMember(f"uav{k + 1}", 27.0, energy_j) for k in range(3)]
    return Air(members, RADIO, settings, ground)


def test_links_hold_where_the_weaker_power_reaches():
    """Neighbours at 1 km are linked, the ends at 2 km are not; the level is as computed."""
    report = air().step(0.5, LINE)
    assert report.links.tolist() == [
        [False, True, False],
        [True, False, True],
        [False, True, False],
    ]
    received_dbm = 10 * np.log10(report.power_w[0] * report.gain[0, 1]) + 30
    assert abs(received_dbm - (27.0 - 94.19)) < 0.05


def test_a_link_takes_both_ends():
    """One end at 20 dBm is heard at -74 dBm, below the sensitivity, though the other is loud."""
    some = air()
    assert some.set_power("uav1", 20.0) == 20.0
    report = some.step(0.5, LINE)
    assert not report.links[0, 1]
    assert report.links[1, 2]
    assert report.rate_bps[1, 0] == 0.0
    assert report.delivery[0, 1] < 0.25
    assert report.delivery[1, 0] > 0.98


def test_the_rate_is_the_planning_rate_of_each_direction():
    """B log2(1 + p h / σ²B), from the sender's own power."""
    some = air()
    some.set_power("uav2", 26.0)
    report = some.step(0.5, LINE)
    snr = dbm_to_w(26.0) * report.gain[1, 0] / dbm_to_w(-110.0)
    assert report.rate_bps[1, 0] == pytest.approx(83.5e6 * np.log2(1 + snr))
    assert report.rate_bps[0, 1] > report.rate_bps[1, 0]
    assert report.throughput_bps == pytest.approx(report.rate_bps.sum() / 2)


def test_the_path_loss_error_moves_every_link():
    """3 dB more loss halves the gain and cuts links whose margin was 2.8 dB."""
    clean, lossy = air().step(0.5, LINE), air(AirSettings(path_loss_error_db=3.0)).step(0.5, LINE)
    assert clean.gain[0, 1] / lossy.gain[0, 1] == pytest.approx(10**0.3)
    assert clean.links.any()
    assert not lossy.links.any()


def test_energy_is_drained_by_the_power_set_until_it_is_gone():
    """0.5 W drain 1 J in 2 s; then the radio is silent, its links gone, and no more is used."""
    some = air(energy_j=1.0)
    for uav in some.uav_ids:
        some.set_power(uav, 26.9897)  # 0.5 W
    assert some.step(1.0, LINE, metered=False).energy_j.tolist() == [0.0, 0.0, 0.0]
    assert some.step(1.5, LINE).energy_j == pytest.approx([0.75] * 3)
    last = some.step(1.5, LINE)
    assert last.energy_j.tolist() == [1.0] * 3
    assert last.power_w.tolist() == [0.0] * 3
    assert not last.links.any()


def test_a_silent_radio_drains_nothing():
    """-inf dBm is silence."""
    some = air()
    some.set_power("uav1", -np.inf)
    report = some.step(2.0, LINE)
    assert report.power_w[0] == report.energy_j[0] == 0.0


def test_dead_radios_and_vehicles_are_off_the_air():
    """Neither sends, is linked or uses energy; a mended radio is back with its setting."""
    some = air()
    some.set_dead("uav1")
    report = some.step(1.0, LINE, switched_on=np.array([True, True, False]))
    assert report.power_w.tolist() == [0.0, pytest.approx(0.5012, abs=1e-4), 0.0]
    assert not report.links.any()
    assert report.delivery.max() == 0.0
    with pytest.raises(InputError, match="uav1 does not answer: it is dead"):
        some.set_power("uav1", 20.0)
    some.set_dead("uav1", dead=False)
    assert some.power_dbm("uav1") == 27.0


def test_a_stuck_radio_reads_back_what_it_really_does():
    """It ignores the setpoint and says so by its reading."""
    some = air()
    some.set_stuck("uav2")
    assert some.set_power("uav2", 10.0) == 27.0
    assert some.power_dbm("uav2") == 27.0


def test_no_radio_exceeds_its_greatest_power():
    """40 dBm asked, 27 dBm set; nonsense is refused by name."""
    some = air()
    assert some.set_power("uav3", 40.0) == 27.0
    with pytest.raises(InputError, match="power of uav3 is nan dBm"):
        some.set_power("uav3", float("nan"))
    with pytest.raises(InputError, match="no radio of uav9; there are uav1, uav2, uav3"):
        some.set_power("uav9", 20.0)


def test_a_ridge_cuts_a_link():
    """A wall across the line takes 35 dB from a link with a margin of 2.8 dB."""
    wall = air(ground=lambda east, north: np.where(abs(east - 500) < 10, 150.0, 0.0))
    report = wall.step(0.5, LINE)
    assert not report.links[0, 1]
    assert report.links[1, 2]


def test_same_seed_same_bytes():
    """Two airs with shadowing, stepped alike, report alike to the last byte."""
    settings = AirSettings(shadowing_sigma_db=5.0, seed=3)
    one, two = air(settings), air(settings)
    for step in range(5):
        at = LINE + 30.0 * step
        assert one.step(0.5, at).gain.tobytes() == two.step(0.5, at).gain.tobytes()
