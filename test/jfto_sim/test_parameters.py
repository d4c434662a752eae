"""Parameters as ArduCopter keeps and tells them."""

import math

import pytest

from jfto_msgs_py.errors import InputError
from jfto_sim import Vehicle, VehicleConfig
from jfto_sim.dialect import mavlink as m
from jfto_sim.parameters import Parameters, definitions
from support.pilot import Pilot, PilotError


@pytest.fixture
def pilot():
    pilot = Pilot(Vehicle())
    pilot.run(5.0)
    return pilot


def read(pilot, name="", index=-1):
    pilot.send(m.MAVLink_param_request_read_message(1, 1, name.encode(), index))
    return pilot.wait(lambda x: x.get_type() == "PARAM_VALUE").message


def test_the_full_list_is_sent(pilot):
    """1364 parameters, each with its index, in about a second."""
    pilot.send(m.MAVLink_param_request_list_message(1, 1))
    heard = pilot.run(1.2)
    values = [h.message for h in heard if h.message.get_type() == "PARAM_VALUE"]
    listed = [v for v in values if v.param_index < 65535]
    assert [v.param_index for v in listed] == list(range(1364))
    assert len({v.param_id for v in listed}) == 1364
    assert "ArduCopter V4.5.5 (142aece2)" in pilot.texts()


def test_single_read_takes_about_a_tenth_of_a_second(pilot):
    """By name the index is 65535, by index it is the index."""
    assert read(pilot, "WPNAV_SPEED").param_value == 1000.0
    by_index = read(pilot, index=1)
    assert (by_index.param_id, by_index.param_index) == ("SYSID_THISMAV", 1)


@pytest.mark.parametrize("name", ["NO_SUCH_PARAM", "wpnav_speed"])
def test_unknown_names_are_not_answered(pilot, name):
    """Neither a read nor a write of an unknown or wrongly cased name is answered."""
    with pytest.raises(PilotError):
        read(pilot, name)
    with pytest.raises(PilotError):
        pilot.set_parameter(name, 1.0)


@pytest.mark.parametrize(
    ("name", "sent", "kept"),
    [
        ("WPNAV_SPEED", 1e9, 1e9),
        ("WPNAV_SPEED", -5.0, -5.0),
        ("RTL_ALT", 1500.7, 1500.0),
        ("RTL_ALT", 70000.0, 70000.0),
    ],
)
def test_nothing_is_range_checked(pilot, name, sent, kept):
    """The stored value is echoed, cut to the parameter's type."""
    pilot.set_parameter(name, sent)
    assert pilot.vehicle.params[name] == pytest.approx(kept)


def test_nan_is_not_answered(pilot):
    """NaN is dropped silently."""
    with pytest.raises(PilotError):
        pilot.set_parameter("WPNAV_SPEED", math.nan)
    assert pilot.vehicle.params["WPNAV_SPEED"] == 1000.0


def test_read_only_is_denied_in_words(pilot):
    """The old value and a text."""
    pilot.set_parameter("MIS_TOTAL", 5.0)
    pilot.run(0.1)
    assert "Param write denied (MIS_TOTAL)" in pilot.texts()
    assert pilot.vehicle.params["MIS_TOTAL"] == 0.0


def test_every_active_port_hears_a_write():
    """PARAM_SET is echoed on all ports that have been heard, a read only on its own."""
    vehicle = Vehicle()
    first, second = Pilot(vehicle, 0), Pilot(vehicle, 1)
    second.run(0.1)
    first.run(1.0)
    frame = m.MAVLink_param_set_message(1, 1, b"RTL_ALT", 900, 6).pack(first.codec)
    vehicle.handle(bytes(frame), 0)
    ports = [p for p, f in vehicle.advance(0.05) if b"RTL_ALT" in f]
    assert ports == [0, 1]


def test_sysid_change_waits_for_a_restart():
    """SYSID_THISMAV is read at power-up."""
    vehicle = Vehicle(VehicleConfig(sysid=3))
    vehicle.params.store("SYSID_THISMAV", 7)
    assert vehicle.sysid == 3
    vehicle.reboot()
    assert vehicle.sysid == 7


def test_unknown_override_is_named():
    """A parameter that does not exist is an error, not ignored."""
    with pytest.raises(InputError, match="NO_SUCH"):
        Parameters({"NO_SUCH": 1.0})


def test_types_are_the_recorded_four():
    """int8, int16, int32 and float."""
    assert {d.kind for d in definitions()} == {2, 4, 6, 9}
