"""The wind that SIM_WIND_* ask for, by height above home, as ArduPilot's simulation has it."""

from __future__ import annotations

import math

from jfto_sim.parameters import Parameters

_FADES, _GROWS = 0, 2  # SIM_WIND_T; 1 is the same at all heights


def asked_wind_mps(params: Parameters, height_m: float) -> tuple[float, float]:
    """Where the air moves to (east, north), m/s, at a height above home.

    By default it fades towards the ground below SIM_WIND_T_ALT, with the root of the height.
    """
    speed, kind, full_m = params["SIM_WIND_SPD"], params["SIM_WIND_T"], params["SIM_WIND_T_ALT"]
    if kind == _FADES and height_m < full_m:
        speed *= math.sqrt(max(height_m, 0.0) / full_m)
    elif kind == _GROWS:
        speed += (height_m - full_m) * params["SIM_WIND_T_COEF"]
    speed, coming = max(speed, 0.0), math.radians(params["SIM_WIND_DIR"])
    return -speed * math.sin(coming), -speed * math.cos(coming)
