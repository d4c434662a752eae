"""Whether a vehicle is ready now: link, position, its own checks, clock, mission on board, wind."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

from jfto_mavlink.preflight.case import Case
from jfto_mavlink.preflight.facts import Snapshot
from jfto_mavlink.preflight.page import AMBER, GREEN, RED, Finding
from jfto_mavlink.preflight.settings import GateSettings
from jfto_world.mission.encoding import ITEMS_MAX

# Texts of ArduCopter's checks that come with a vehicle just switched on, and go by themselves.
_SETTLES = re.compile(
    r"AHRS|EKF|Need (Position|Alt) Estimate|need position|without position|Bad fix|HDOP|differ by|"
    r"GPS( \d)?: not healthy|GPS glitching|inconsistent|ettling|nitialising|Waiting for|"
    r"Logging not started|heater temp low|temperature cal running",
    re.IGNORECASE,
)
_SKY = "Give it a clear sky and time."
_WAITS = "not ready yet, run waits for it"
# Beyond what the plan allows for by more than this nobody should start.
WIND_MORE_MPS = 3.0
# Bytes in the file of missions on a card: each item, and before the first.
_CARD_ITEM, _CARD_HEAD = 15, 4


def unready(now: Snapshot, settings: GateSettings) -> Iterator[Finding]:
    """What speaks against arming and may be over in a moment.

    What passes by itself is red where nobody waits for it any longer, else amber.
    """
    if now.silent_s > settings.silent_max_s:
        yield Finding("autopilot", RED, f"no heartbeat for {now.silent_s:.0f} s")
    if now.armed:
        yield Finding("autopilot", RED, "is armed already", "Disarm it first.")
    if (now.gps_fix or 0) < settings.gps_fix_min:
        text = f"GPS fix is {now.gps_fix}, needs {settings.gps_fix_min}"
        yield _passing("position", text, _SKY, settings)
    if (now.satellites or 0) < settings.satellites_min:
        text = f"{now.satellites} satellites, needs {settings.satellites_min}"
        yield _passing("position", text, _SKY, settings)
    if not now.ekf_ready:
        yield _passing(
            "position", "position estimate is not ready", "Let it stand still.", settings
        )
    if now.fence_breached:
        yield Finding("autopilot", RED, "is outside its fence")
    if not now.prearm_ok:
        yield from _own_checks(now, settings)
    limit_s, error_s = settings.utc_error_max_s, now.utc_error_s
    if limit_s is not None and (error_s is None or abs(error_s) > limit_s):
        clock = "unknown" if error_s is None else f"{error_s:+.2f} s off"
        text = f"its clock is {clock}, a quarter slot is {limit_s:.2f} s"
        cure = "Wait for GPS time, or set this computer's clock."
        if error_s is None:
            yield _passing("clock", text, cure, settings)
        else:
            yield Finding("clock", RED, text, cure)


def _own_checks(now: Snapshot, settings: GateSettings) -> Iterator[Finding]:
    """What the autopilot says that it misses, in its own words."""
    lasting = [text for text in now.prearm_texts if not _SETTLES.search(text)]
    passing = [text for text in now.prearm_texts if _SETTLES.search(text)]
    if lasting:
        yield Finding("autopilot", RED, " ".join(f'"{text}"' for text in lasting))
    if passing:
        text = " ".join(f'"{text}"' for text in passing)
        yield _passing("autopilot", text, "Let it stand still.", settings)
    if not now.prearm_texts:
        text = "checks of the autopilot do not pass"
        if now.ekf_ready:
            yield Finding("autopilot", RED, text)
        else:
            # It has not come to them yet.
            yield _passing("autopilot", text, "Let it stand still.", settings)


def _passing(topic: str, text: str, cure: str, settings: GateSettings) -> Finding:
    if not settings.waited_for:
        return Finding(topic, RED, text, cure)
    return Finding(topic, AMBER, f"{text}: {_WAITS}", cure, waits=True)


def ready(case: Case) -> Iterator[Finding]:
    """The same with what is right: position, the autopilot's checks and the clock."""
    now = case.now
    found = tuple(unready(now, case.settings))
    yield from found
    topics = {finding.topic for finding in found}
    if "position" not in topics:
        text = f"GPS fix {now.gps_fix}, {now.satellites} satellites, position estimate ready"
        yield Finding("position", GREEN, text)
    if "autopilot" not in topics:
        yield Finding("autopilot", GREEN, "disarmed, its own checks pass")
    if "clock" not in topics:
        known = now.utc_error_s
        text = "not compared yet" if known is None else f"{known:+.2f} s off this computer's"
        loose = "" if case.settings.utc_error_max_s else "; the plan is not held by the clock"
        yield Finding("clock", GREEN, text + loose)


def on_board(case: Case) -> Iterator[Finding]:
    """Whether the vehicle holds the mission of the plan, where that was read back."""
    for text in case.aboard.differing:
        yield Finding("mission", RED, f"mission on board: {text}", "Upload.")
    items = len(case.mission.mission.items)
    card_kb = case.aboard.get("BRD_SD_MISSION", 0.0)
    held = int((card_kb * 1024 - _CARD_HEAD) / _CARD_ITEM) if card_kb > 0 else ITEMS_MAX
    if items <= held:
        return
    if card_kb > 0:
        text = f"its mission has {items} items, its card is to hold {held} (BRD_SD_MISSION)"
        cure = f"Set BRD_SD_MISSION to {math.ceil(items * _CARD_ITEM / 1024) + 1} and reboot."
        yield Finding("mission", RED, text, cure)
    else:
        text = f"its mission has {items} items; boards hold {held} at least, this one does not say"
        yield Finding("mission", AMBER, text, "The upload will tell; a card holds more.")


def wind(case: Case) -> Iterator[Finding]:
    """What the vehicle takes for the wind against what the plan leaves room for."""
    limit, told = case.settings.wind_max_mps, case.now.wind_mps
    if not told:
        # A copter says 0 m/s in any wind: always on the ground, aloft without EK3_DRAG_BCOEF_*.
        planned = "" if limit is None else f"; the plan allows for {limit:g} m/s"
        text = f"standing here it cannot tell the wind{planned}"
        yield Finding("wind", AMBER, text, "Measure it by hand.")
        return
    if limit is None:
        yield Finding("wind", GREEN, f"tells {told:.1f} m/s; the plan names no limit")
        return
    text = f"tells {told:.1f} m/s, the plan allows for {limit:g} m/s"
    if told <= limit:
        yield Finding("wind", GREEN, text)
        return
    level = RED if told > limit + WIND_MORE_MPS else AMBER
    cure = f"Wait, or plan with trajectory.wind_mps {told:.0f}."
    yield Finding("wind", level, f"{text}: it will be late and pass wider", cure)
