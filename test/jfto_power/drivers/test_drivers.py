"""What all radio drivers keep to, and what each has of its own."""

from __future__ import annotations

import os
import stat
import sys

import numpy as np
import pytest

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.records.radio import Radio
from jfto_power.drivers import IwDriver, LogDriver, RadioError, SimDriver
from jfto_sim import VehicleConfig
from jfto_sim.air import Air, AirMember, FleetAir
from jfto_sim.server import ServerSettings, SimServer

# Stands where the tool is: keeps one power in a file beside it, as the kernel would.
IW = """\
#!{python}
import pathlib, sys
state = pathlib.Path({state!r})
words = sys.argv[1:]
if words[1] != "mesh0":
    sys.exit("command failed: No such device (-19)")
if words[2] == "info":
    power = state.read_text() if state.exists() else "20.00"
    if power == "down":
        print("Interface mesh0\\n\\ttype managed")
    else:
        print(f"Interface mesh0\\n\\tifindex 3\\n\\ttype mesh point\\n\\ttxpower {{power}} dBm")
elif words[2:5] == ["set", "txpower", "fixed"]:
    mbm = int(words[5])
    if mbm < 0 or mbm % 100:
        sys.exit("command failed: Operation not supported (-95)")
    if mbm > 3000:
        sys.exit("command failed: Invalid argument (-22)")
    state.write_text(f"{{mbm / 100:.2f}}")
else:
    sys.exit("Usage: iw ...")
"""


def install_iw(folder, monkeypatch):
    """A tool of that name, first on PATH."""
    tool = folder / "iw"
    tool.write_text(IW.format(python=sys.executable, state=str(folder / "power")))
    tool.chmod(tool.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")


@pytest.fixture
def server():
    """One simulated vehicle with a radio of 30 dBm at most, on a control port that is free."""
    air = Air([AirMember("uav1", 30.0, 100.0)], Radio())
    carried = FleetAir(air, lambda lat, _lon, alt: np.zeros((len(lat), 3)) + alt[:, None])
    settings = ServerSettings((("udp:127.0.0.1:0",),), control_port=0)
    with SimServer([VehicleConfig()], settings, carried) as running:
        yield running


@pytest.fixture(params=["log", "sim", "iw"])
def driver(request, tmp_path, monkeypatch, server):
    """Each driver, serving uav1."""
    if request.param == "log":
        return LogDriver(["uav1"], lambda line: None)
    if request.param == "sim":
        return SimDriver({"uav1": 1}, server.control_address)
    install_iw(tmp_path, monkeypatch)
    return IwDriver("uav1", "mesh0")


def test_what_is_applied_is_what_is_read(driver):
    """Whole decibels are set exactly; the newest counts; reading changes nothing."""
    assert driver.apply("uav1", 23.0) == 23.0
    assert driver.apply("uav1", 17.0) == 17.0
    assert [driver.read("uav1"), driver.read("uav1")] == [17.0, 17.0]


def test_a_power_between_steps_is_never_rounded_down(driver):
    """Less would break the links that it was computed for; one step at most is added."""
    assert 20.3 <= driver.apply("uav1", 20.3) <= 21.0


def test_silence_is_the_least_that_a_radio_can_do(driver):
    """-inf dBm is taken, and read back as what it became."""
    applied = driver.apply("uav1", -np.inf)
    assert applied <= 0.0
    assert driver.read("uav1") == applied


@pytest.mark.parametrize("dbm", [float("nan"), float("inf")])
def test_no_driver_takes_nonsense(driver, dbm):
    """Neither NaN nor +inf is a power."""
    with pytest.raises(InputError, match=f"power of uav1 is {dbm} dBm"):
        driver.apply("uav1", dbm)


def test_no_driver_touches_another_radio(driver):
    """Whom it does not serve it refuses by name."""
    with pytest.raises(InputError, match="not of uav2"):
        driver.apply("uav2", 20.0)
    with pytest.raises(InputError, match="not of uav2"):
        driver.read("uav2")


def test_the_log_says_what_would_be_set():
    """One line per power, with unit; nothing can be read before the first."""
    lines = []
    driver = LogDriver(["uav1"], lines.append)
    with pytest.raises(RadioError, match="no power was set yet"):
        driver.read("uav1")
    driver.apply("uav1", 23.456)
    assert lines == ["uav1: tx power 23.46 dBm"]


def test_a_simulated_radio_can_die_stick_and_be_mended(server):
    """Dead: an error that says so. Stuck: another power is read back. Mended: well again."""
    driver = SimDriver({"uav1": 1}, server.control_address)
    assert driver.apply("uav1", 25.0) == 25.0
    server.fault("radio 1 stuck")
    assert driver.apply("uav1", 10.0) == 25.0
    server.fault("radio 1 dead")
    with pytest.raises(RadioError, match="uav1 does not answer: it is dead"):
        driver.apply("uav1", 10.0)
    server.fault("radio 1 mend")
    assert driver.apply("uav1", 99.0) == 30.0


def test_no_simulator_no_power(server):
    """The message names the line, the address and what to look at."""
    host, port = server.control_address
    server.stop()
    with pytest.raises(RadioError, match=f"'radio 1' got no answer from {host}:{port}. Is the sim"):
        SimDriver({"uav1": 1}, (host, port), timeout_s=0.05).read("uav1")


def test_what_is_wrong_with_a_radio_order_is_said(server):
    """Words that are no order, radios that there are none of, vehicles without radios."""
    with pytest.raises(InputError, match="radio order is 'loud', must be a power in dBm, dead"):
        server.fault("radio 1 loud")
    with pytest.raises(InputError, match="There is no vehicle 7"):
        server.fault("radio 7 dead")
    with (
        SimServer([VehicleConfig()], ServerSettings((("udp:127.0.0.1:0",),))) as bare,
        pytest.raises(InputError, match="carry no radios"),
    ):
        bare.fault("radio 1 dead")


def test_iw_sets_millibels_in_steps_the_radio_can_do(tmp_path, monkeypatch):
    """22.1 dBm become 23 dBm, 2300 mBm; 22.0000000001 stays 22; half decibels where asked."""
    install_iw(tmp_path, monkeypatch)
    driver = IwDriver("uav1", "mesh0")
    assert driver.apply("uav1", 22.1) == 23.0
    assert driver.apply("uav1", 22.0 + 1e-10) == 22.0
    with pytest.raises(RadioError, match=r"fixed 2250' failed.*cannot set a power, or not in such"):
        IwDriver("uav1", "mesh0", step_db=0.5).apply("uav1", 22.1)


def test_what_iw_refuses_is_told_with_a_cure(tmp_path, monkeypatch):
    """No such interface, a power that the channel forbids, an interface that is down, no tool."""
    install_iw(tmp_path, monkeypatch)
    with pytest.raises(RadioError, match=r"No such device \(-19\). Name the radio's interface"):
        IwDriver("uav1", "wlan7").apply("uav1", 20.0)
    with pytest.raises(RadioError, match=r"Invalid argument \(-22\). The channel in use"):
        IwDriver("uav1", "mesh0").apply("uav1", 33.0)
    (tmp_path / "power").write_text("down")
    with pytest.raises(RadioError, match=r"mesh0 reports no txpower\. Is the interface up"):
        IwDriver("uav1", "mesh0").read("uav1")
    with pytest.raises(RadioError, match="no-such-iw is not installed"):
        IwDriver("uav1", "mesh0", command=["no-such-iw"]).read("uav1")
    hung = IwDriver("uav1", "mesh0", command=["sleep", "60"], timeout_s=0.1)
    with pytest.raises(RadioError, match="sleep"):
        hung.read("uav1")
