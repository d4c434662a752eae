"""Station, battery, GPS, fence and motor failsafes."""

import pytest

from jfto_sim import Vehicle, VehicleConfig
from jfto_sim.battery import BatteryState
from jfto_sim.dialect import mavlink as m
from jfto_sim.geodesy import move
from jfto_sim.mission.items import Item
from support.pilot import Pilot

ORIGIN = (473977420, 85455940)
AUTO, RTL, LAND = 3, 6, 9


def flying(**parameters):
    pilot = Pilot(Vehicle(VehicleConfig(parameters=parameters)))
    pilot.take_off(15.0)
    lat, lon = move(*ORIGIN, 0.0, 400.0)
    pilot.upload([Item(16, 0, x=ORIGIN[0], y=ORIGIN[1]), Item(16, 6, x=lat, y=lon, z_m=15.0)])
    pilot.command(300)
    pilot.run(2.0)
    return pilot


def status(pilot):
    beats = [h.message for h in pilot.heard if h.message.get_type() == "HEARTBEAT"]
    return beats[-1].system_status


def test_lost_station_does_nothing_by_default():
    """FS_GCS_ENABLE 0: the mission goes on."""
    pilot = flying()
    pilot.beating = False
    pilot.run(10.0)
    assert pilot.vehicle.mode.number == AUTO


@pytest.mark.parametrize(("options", "mode", "text"), [
    (0, RTL, "GCS Failsafe"), (2, AUTO, "GCS Failsafe - Continuing Auto Mode")])  # fmt: skip
def test_lost_station(options, mode, text):
    """5 s after the last heartbeat RTL, or a text only; cleared on return, the mode stays."""
    pilot = flying(FS_GCS_ENABLE=1, FS_OPTIONS=options)
    pilot.beating = False
    pilot.run(4.0)
    assert text not in pilot.texts()
    pilot.run(2.5)
    assert text in pilot.texts()
    assert pilot.vehicle.mode.number == mode
    assert status(pilot) == 5
    pilot.beating = True
    pilot.run(2.5)
    assert "GCS Failsafe Cleared" in pilot.texts()
    assert pilot.vehicle.mode.number == mode


def test_only_the_named_station_counts():
    """Heartbeats of another system id do not feed the failsafe."""
    pilot = flying(FS_GCS_ENABLE=1)
    pilot.beating = False
    other = Pilot(pilot.vehicle, system=200)
    other.run(7.0)
    assert pilot.vehicle.mode.number == RTL


def test_low_then_critical_battery():
    """Each after BATT_LOW_TIMER seconds: RTL, then LAND, then no arming."""
    pilot = flying(BATT_FS_LOW_ACT=2, BATT_LOW_VOLT=11.5, BATT_FS_CRT_ACT=1, BATT_CRT_VOLT=10.5)
    pilot.set_parameter("SIM_BATT_VOLTAGE", 11.3)
    pilot.run(9.5)
    assert pilot.vehicle.battery.state is BatteryState.HEALTHY
    pilot.run(1.0)
    assert pilot.vehicle.mode.number == RTL
    assert any(t.startswith("Battery 1 is low 11.30V used") for t in pilot.texts())
    pilot.set_parameter("SIM_BATT_VOLTAGE", 10.2)
    pilot.run(10.5)
    assert pilot.vehicle.mode.number == LAND
    pilot.run(90.0)
    assert not pilot.vehicle.flight.motors.armed
    pilot.command(176, 1, 4)
    assert pilot.command(400, 1) == m.MAV_RESULT_FAILED
    pilot.run(0.1)
    assert "Arm: Battery failsafe" in pilot.texts()


def test_lost_gps():
    """8 s after the loss LAND; on return a text, the mode stays, AUTO resumes by command."""
    pilot = flying()
    pilot.set_parameter("SIM_GPS_DISABLE", 1)
    pilot.run(7.5)
    assert pilot.vehicle.mode.number == AUTO
    pilot.run(1.0)
    assert pilot.vehicle.mode.number == LAND
    assert pilot.texts()[-2:] == ["EKF variance", "EKF Failsafe: changed to LAND Mode"]
    assert pilot.command(176, 1, 4) == m.MAV_RESULT_FAILED
    pilot.set_parameter("SIM_GPS_DISABLE", 0)
    pilot.run(2.0)
    assert "EKF Failsafe Cleared" in pilot.texts()
    assert pilot.vehicle.mode.number == LAND
    assert pilot.command(176, 1, 3) == m.MAV_RESULT_ACCEPTED


def test_circle_fence():
    """Crossing FENCE_RADIUS in AUTO: a text and RTL; AUTO by command is accepted outside."""
    pilot = flying(FENCE_ENABLE=1, FENCE_TYPE=2, FENCE_RADIUS=40)
    pilot.wait(lambda x: x.get_type() == "STATUSTEXT" and x.text == "Fence Breached", 30.0)
    assert pilot.vehicle.body.position_m[1] == pytest.approx(40.0, abs=1.5)
    pilot.run(0.2)
    assert pilot.vehicle.mode.number == RTL
    assert pilot.command(176, 1, 3) == m.MAV_RESULT_ACCEPTED


def test_polygon_fence_and_ceiling():
    """Uploaded figures count when FENCE_TYPE says so, and so does FENCE_ALT_MAX."""
    pilot = flying(FENCE_TYPE=4)
    corners = [move(*ORIGIN, e, n) for e, n in ((-50, -50), (50, -50), (50, 60), (-50, 60))]
    pilot.upload([Item(5001, 0, (4, 0, 0, 0), *corner) for corner in corners], 1)
    pilot.set_parameter("FENCE_ENABLE", 1)
    pilot.wait(lambda x: x.get_type() == "STATUSTEXT" and x.text == "Fence Breached", 30.0)
    assert pilot.vehicle.body.position_m[1] == pytest.approx(60.0, abs=2.0)
    high = flying(FENCE_TYPE=1, FENCE_ALT_MAX=14)
    high.set_parameter("FENCE_ENABLE", 1)
    high.run(0.5)
    assert high.vehicle.mode.number == RTL


def test_failed_motor():
    """It falls within seconds; HEARTBEAT still says armed and AUTO."""
    pilot = flying()
    pilot.set_parameter("SIM_ENGINE_MUL", 0.2)
    pilot.run(6.0)
    assert pilot.vehicle.body.landed
    assert pilot.vehicle.flight.motors.armed
    assert pilot.vehicle.mode.number == AUTO
    assert {"Potential Thrust Loss (1)"} <= set(pilot.texts())
    assert any(t.startswith("SIM Hit ground at") for t in pilot.texts())


def test_idle_vehicle_disarms():
    """Armed but not flying: disarmed after DISARM_DELAY, 10 s."""
    pilot = Pilot(Vehicle())
    pilot.ready()
    pilot.command(176, 1, 4)
    pilot.command(400, 1)
    pilot.run(9.5)
    assert pilot.vehicle.flight.motors.armed
    pilot.run(1.0)
    assert not pilot.vehicle.flight.motors.armed


def test_disarm_in_flight_needs_force():
    """FAILED without 21196; with it the motors stop."""
    pilot = flying()
    assert pilot.command(400, 0) == m.MAV_RESULT_FAILED
    assert pilot.command(400, 0, 21196) == m.MAV_RESULT_ACCEPTED
