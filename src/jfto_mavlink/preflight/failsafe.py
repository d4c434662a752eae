"""What a vehicle does by itself when something fails: one table of settings that are odd."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from jfto_mavlink.preflight.case import Case
from jfto_mavlink.preflight.page import AMBER, GREEN, RED, Finding

_BATTERY = {
    0: "nothing",
    1: "land",
    2: "home",
    3: "home the way it came",
    4: "home the way it came, or land",
    5: "stop the motors",
    6: "DO_LAND_START or home",
    7: "brake, or land",
}
_GCS = {0: "flies on", 1: "home", 2: "flies on", 3: "home the way it came", 5: "land"}
_THROTTLE = {0: "nothing", 1: "home", 2: "flies on", 3: "land", 4: "home", 5: "land"}
_EKF = {0: "nothing", 1: "land", 2: "hold height", 3: "land"}
# Bits of FS_OPTIONS with which AUTO, or GUIDED, goes on.
_AUTO_GOES_ON, _GUIDED_GOES_ON = 1 | 2, 4
_ALL_HOME = "home"


@dataclass(frozen=True)
class Rule:
    """Values of a parameter that are odd: how bad, in words, and the cure."""

    name: str
    values: tuple[float, ...]
    level: str
    text: str
    cure: str
    only_guided: bool = False


_RULES = (
    Rule("BATT_FS_LOW_ACT", (0,), AMBER, "a low battery does nothing", "Set it to 2 (home)."),
    Rule("BATT_FS_LOW_ACT", (5,), RED, "a low battery stops the motors", "Set it to 2 (home)."),
    Rule(
        *("BATT_FS_LOW_ACT", (1,), AMBER),
        "a low battery lands it wherever it is, on a slope too",
        "Set it to 2 (home).",
    ),
    Rule("BATT_FS_CRT_ACT", (5,), RED, "an empty battery stops the motors", "Set it to 1 (land)."),
    Rule("FS_THR_ENABLE", (0,), AMBER, "a lost remote control does nothing", "Set it to 1 (home)."),
    Rule("FS_EKF_ACTION", (0,), AMBER, "a lost position does nothing", "Set it to 1 (land)."),
    Rule(
        *("FS_GCS_ENABLE", (0,), AMBER),
        "without its station a guided vehicle hovers until its battery is empty",
        "Set it to 1 (home).",
        only_guided=True,
    ),
    Rule("FENCE_ACTION", (0,), AMBER, "its fence only reports a breach", "Set it to 1 (home)."),
)


def failsafe(case: Case) -> Iterator[Finding]:
    """What the vehicle would do, in one line, and a finding for each odd setting."""
    known = case.aboard.parameters
    if not known:
        yield Finding("failsafe", AMBER, "its failsafes are not known")
        return
    odd: set[str] = set()
    for rule in _RULES:
        if rule.name not in known or case.value(rule.name) not in rule.values:
            continue
        if rule.name == "FENCE_ACTION" and not case.value("FENCE_ENABLE"):
            continue
        if rule.only_guided and not case.settings.guided:
            continue
        text = f"{rule.name} {case.value(rule.name):g}: {rule.text}"
        odd.add(rule.name)
        yield Finding("failsafe", rule.level, text, rule.cure)
    yield from _never(case)
    yield Finding("failsafe", GREEN, _summary(case, odd))


def _never(case: Case) -> Iterator[Finding]:
    """Actions whose threshold is off."""
    for kind, words in (("LOW", "low"), ("CRT", "empty")):
        act = case.value(f"BATT_FS_{kind}_ACT")
        volt, mah = case.value(f"BATT_{kind}_VOLT"), case.value(f"BATT_{kind}_MAH")
        if act and not volt and not mah:
            text = f"BATT_FS_{kind}_ACT {act:g} never acts: no {words} voltage or charge is set"
            yield Finding("failsafe", AMBER, text, f"Set BATT_{kind}_VOLT or BATT_{kind}_MAH.")


def _summary(case: Case, odd: set[str]) -> str:
    """What each failsafe does, without those in `odd`: they have a line of their own."""
    table = (
        ("battery low", "BATT_FS_LOW_ACT", _BATTERY),
        ("battery empty", "BATT_FS_CRT_ACT", _BATTERY),
        ("station lost", "FS_GCS_ENABLE", _GCS),
        ("remote lost", "FS_THR_ENABLE", _THROTTLE),
        ("position lost", "FS_EKF_ACTION", _EKF),
    )
    said = []
    for subject, name, words in table:
        value = int(case.value(name))
        if name not in odd:
            said.append(f"{subject}: {words.get(value, f'{name} {value}')}")
    options = int(case.value("FS_OPTIONS"))
    goes_on = _GUIDED_GOES_ON if case.settings.guided else _AUTO_GOES_ON
    if options & goes_on:
        said.append(f"FS_OPTIONS {options} lets it fly on")
    return "; ".join(said) or "nothing else is set"
