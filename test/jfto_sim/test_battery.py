"""What the battery gives, and what is left of it."""

from __future__ import annotations

import pytest

from jfto_sim import Vehicle, VehicleConfig
from jfto_sim.battery import Battery
from jfto_sim.parameters import Parameters
from support.pilot import Pilot


def drained(share: float, **parameters: float) -> Battery:
    """A battery of 5 Ah after a share of its charge was drawn in the hover."""
    battery = Battery(Parameters({"SIM_BATT_CAP_AH": 5.0, **parameters}))
    for _ in range(round(3600 * 5.0 * share / 28.0)):
        battery.draw(armed=True, thrust=1.0, dt_s=1.0)
    return battery


def test_the_voltage_is_constant_unless_a_capacity_is_simulated():
    """As in ArduPilot's simulation of a plain quadcopter."""
    assert drained(0.5, SIM_BATT_CAP_AH=0.0).voltage_v == pytest.approx(12.6, abs=1e-4)


def test_a_simulated_capacity_lets_the_voltage_fall_and_sag():
    """Below 11.5 V half empty, less under load than at rest; more current for the same power."""
    full, half, empty = drained(0.0), drained(0.5), drained(0.95)
    assert full.voltage_v > 12.5
    assert 10.8 < half.voltage_v < 11.5
    assert empty.voltage_v < 10.0
    loaded = half.voltage_v
    half.draw(armed=False, thrust=0.0, dt_s=1.0)
    assert half.voltage_v > loaded + 0.2
    assert half.current_a == 0.0
    assert empty.current_a > 28.1 * 1.1


def test_an_emptying_battery_lands_the_vehicle():
    """The voltage limit is reached by flying, without a hand on it."""
    pilot = Pilot(
        Vehicle(
            VehicleConfig(
                parameters={"SIM_BATT_CAP_AH": 1.0, "BATT_LOW_VOLT": 11.0, "BATT_FS_LOW_ACT": 1.0}
            )
        )
    )
    pilot.take_off(10.0)
    pilot.wait_text("Battery 1 is low 1", 120.0)
    pilot.wait_mode(9)
