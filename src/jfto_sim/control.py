"""Faults on command: one line of text each, from a script, the command line or a control socket.

link 1 loss=0.1 delay_s=0.3 direction=to      one direction (to, from, both) of all its ports
link 1 port=1 cut=1                           one port only
mend 1                                        all links of a vehicle clean again
gps 1 off | gps 1 on                          GPS loss
motor 1 fail | motor 1 mend                   one motor at a fifth of its thrust
battery 1 10.2                                volts
wind 1 5 270                                  m/s, degrees it comes from
drift 1 50                                    clock drift, parts per million
param 1 FENCE_ALT_MAX 60                      any parameter, as if another station had set it
reboot 1 | kill 1                             restart; power off
radio 1 | radio 1 23.5                        power that is set, dBm; set it (-inf: silence)
radio 1 dead | radio 1 stuck | radio 1 mend   it sends nothing; it obeys no more; it is well again
"""

from __future__ import annotations

from dataclasses import fields, replace

from jfto_msgs_py.errors import InputError
from jfto_sim.air import FleetAir
from jfto_sim.faults import LinkFaults
from jfto_sim.station import Station

_LINK_FIELDS = {f.name for f in fields(LinkFaults)}
_SWITCHES = {
    ("gps", "off"): ("SIM_GPS_DISABLE", 1.0),
    ("gps", "on"): ("SIM_GPS_DISABLE", 0.0),
    ("motor", "fail"): ("SIM_ENGINE_MUL", 0.2),
    ("motor", "mend"): ("SIM_ENGINE_MUL", 1.0),
}


def _number(text: str, what: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{what} is '{text}', must be a number.") from None


def apply(stations: dict[int, Station], line: str, air: FleetAir | None = None) -> str:
    """Carry out one line; raises InputError that says what is wrong with it.

    Returns what there is to say, "" for most. `air` has the radios, in the order of the stations.
    """
    words = line.split()
    if len(words) < 2 or not words[1].isdigit():
        raise InputError(f"'{line}' must be: fault, vehicle number, values.")
    verb, rest = words[0], words[2:]
    station = stations.get(int(words[1]))
    if station is None:
        raise InputError(f"There is no vehicle {words[1]}; there are {sorted(stations)}.")
    if verb == "radio":
        if air is None:
            raise InputError("These vehicles carry no radios: start them from a plan.")
        return air.order(list(stations).index(int(words[1])), rest)
    _fault(station, verb, rest, line)
    return ""


def _fault(station: Station, verb: str, rest: list[str], line: str) -> None:
    params = station.vehicle.params
    if verb == "link":
        _link(station, rest)
    elif verb == "mend":
        station.mend()
    elif (verb, *rest) in _SWITCHES:
        params.store(*_SWITCHES[(verb, rest[0])])
    elif verb == "battery" and len(rest) == 1:
        params.store("SIM_BATT_VOLTAGE", _number(rest[0], "battery voltage"))
    elif verb == "wind" and len(rest) == 2:
        params.store("SIM_WIND_SPD", _number(rest[0], "wind speed"))
        params.store("SIM_WIND_DIR", _number(rest[1], "wind direction"))
    elif verb == "drift" and len(rest) == 1:
        station.vehicle.clock.drift_ppm = _number(rest[0], "clock drift")
    elif verb == "param" and len(rest) == 2:
        station.vehicle.set_parameter(rest[0], _number(rest[1], rest[0]))
    elif verb == "reboot" and not rest:
        station.reboot()
    elif verb == "kill" and not rest:
        station.vehicle.kill()
    else:
        raise InputError(f"'{line}' is not a fault this simulator knows.")


def _link(station: Station, words: list[str]) -> None:
    ports = list(range(len(station.links)))
    directions: tuple[str, ...] = ("to", "from")
    changes: dict[str, float | bool] = {}
    for word in words:
        name, _, value = word.partition("=")
        if name == "port":
            ports = [int(_number(value, "port"))]
        elif name == "direction":
            directions = ("to", "from") if value == "both" else (value,)
        elif name == "cut":
            changes[name] = value in ("1", "true")
        elif name in _LINK_FIELDS:
            changes[name] = _number(value, f"link {name}")
        else:
            raise InputError(f"link {name} is unknown; known are {sorted(_LINK_FIELDS)}.")
    if not set(directions) <= {"to", "from"}:
        raise InputError(f"link direction is {directions[0]}, must be to, from or both.")
    if not set(ports) <= set(range(len(station.links))):
        raise InputError(f"Vehicle has ports 0 to {len(station.links) - 1}, not {ports[0]}.")
    for port in ports:
        for direction in directions:
            pipe = station.links[port][direction]
            pipe.faults = replace(pipe.faults, **changes)  # type: ignore[arg-type]
