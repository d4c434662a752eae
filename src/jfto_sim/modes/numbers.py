"""ArduCopter's mode numbers and what each mode needs."""

from __future__ import annotations

from enum import IntEnum


class Mode(IntEnum):
    """Numbers as in HEARTBEAT.custom_mode."""

    STABILIZE = 0
    ALT_HOLD = 2
    AUTO = 3
    GUIDED = 4
    LOITER = 5
    RTL = 6
    LAND = 9
    BRAKE = 17


MODE_NAMES = {mode.value: mode.name for mode in Mode}
ARMABLE = frozenset({Mode.STABILIZE, Mode.ALT_HOLD, Mode.GUIDED, Mode.LOITER})
NEEDS_POSITION = frozenset({Mode.AUTO, Mode.GUIDED, Mode.LOITER, Mode.RTL, Mode.BRAKE})
# bits of HEARTBEAT.base_mode without the armed bit
_PLAIN, _GUIDED = 81, 89
BASE_MODE = {
    mode.value: _GUIDED
    if mode in (Mode.AUTO, Mode.GUIDED, Mode.LOITER, Mode.RTL, Mode.BRAKE)
    else _PLAIN
    for mode in Mode
}
