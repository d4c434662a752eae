"""States as short words with a style: colour never stands alone."""

from __future__ import annotations

from collections.abc import Sequence

from rich.text import Text

from jfto.flight.screen.state import (
    FLYING,
    HOLDING,
    HOME,
    LANDED,
    SILENT,
    UNHEARD,
    FlightState,
    LinkState,
    UavState,
)
from jfto.reporting.palette import uav_colour, uav_sign
from jfto_msgs_py.records.event import ERROR, WARN, Event

GOOD, NOTE, BAD, SOFT = "green", "bold yellow", "bold red", "bright_black"
# The palette's black is for paper.
_ON_TERMINAL = {"#000000": "bright_white", "#0072B2": "#3B9BDD"}
_PHASE_STYLE = {FLYING: GOOD, HOLDING: GOOD, HOME: GOOD, LANDED: GOOD, SILENT: BAD, UNHEARD: NOTE}
# As in the report's 3-D view: little to spare below 1 dB, some below 6.
TIGHT_DB, SOME_DB = 1.0, 6.0
ON_TIME_S, VERY_LATE_S = 1.0, 5.0
LOW_SHARE = 0.2
_BAR = 8


def clock(seconds: float | None) -> str:
    """Minutes and seconds, with a sign before lift-off."""
    if seconds is None:
        return "--:--"
    whole = round(abs(seconds))
    return f"{'-' if seconds < 0 and whole else ''}{whole // 60:02d}:{whole % 60:02d}"


def name(uav: UavState) -> Text:
    """Sign and name of a UAV in its colour."""
    colour = uav_colour(uav.index)
    colour = _ON_TERMINAL.get(colour, colour)
    return Text.assemble((uav_sign(uav.index), colour), " ", (uav.id, f"bold {colour}"))


def phase(uav: UavState) -> Text:
    """What the UAV does; for a silent one since when."""
    words = uav.phase
    if uav.phase == SILENT and uav.age_s is not None:
        words = f"✗ silent {uav.age_s:.0f} s"
    return Text(words, _PHASE_STYLE.get(uav.phase, ""))


def waypoint(uav: UavState) -> Text:
    """Waypoints done, and when the next is due."""
    text = Text(f"{uav.done}/{uav.total}")
    if uav.phase == FLYING and uav.next_in_s is not None:
        # One that is overdue is due now: how late is said beside it.
        text.append(f", {max(uav.next_in_s, 0.0):.0f} s", SOFT)
    return text


def status(uav: UavState) -> Text:
    """The one thing to know where there is no room for two: timing in flight, else what it does."""
    return timing(uav) if uav.phase == FLYING else phase(uav)


def timing(uav: UavState) -> Text:
    """Seconds early or late in texts."""
    late = uav.late_s
    if late is None:
        return Text("–", SOFT)
    if abs(late) <= ON_TIME_S:
        return Text("on time", GOOD)
    if late < 0:
        return Text(f"{-late:.1f} s early", "cyan")
    return Text(f"{late:.1f} s late", BAD if late > VERY_LATE_S else NOTE)


def energy(uav: UavState, *, bar: bool) -> Text:
    """Energy left for transmitting, as a bar and in percent."""
    share = uav.energy_share
    if share is None:
        return Text("–", SOFT)
    style = BAD if share <= 0 else NOTE if share < LOW_SHARE else GOOD
    words = "empty" if share <= 0 else f"{100 * share:3.0f} %" + (" low" if style is NOTE else "")
    text = Text()
    if bar:
        full = min(round(share * _BAR), _BAR)
        text.append("█" * full, style).append("░" * (_BAR - full), SOFT).append(" ")
    return text.append(words, style)


def battery(uav: UavState) -> Text:
    """Flight battery in percent."""
    if uav.battery_percent is None:
        return Text("–", SOFT)
    low = uav.battery_percent < 100 * LOW_SHARE
    return Text(f"{uav.battery_percent:.0f} %" + (" low" if low else ""), BAD if low else "")


def links(uav: UavState, k_min: int, most: int) -> Text:
    """Neighbours with what each link can lose, the weakest first."""
    shown = sorted(uav.links, key=lambda link: link.spare_db)
    text = Text()
    if uav.phase in {FLYING, HOLDING} and uav.neighbours < k_min:
        text.append(f"✗ {uav.neighbours} of {k_min} ", BAD)
    for number, one in enumerate(shown[:most]):
        text.append("  " if number else "").append(one.peer + " ").append_text(spare(one))
    if len(shown) > most:
        text.append(f"  +{len(shown) - most}", SOFT)
    return text if text.plain else Text("–", SOFT)


def spare(link: LinkState) -> Text:
    """What a link can lose; its style says how much that is, a mark where it is little."""
    if link.spare_db == float("-inf"):
        return Text("off✗", BAD)
    if link.spare_db < 0:
        return Text(f"{link.spare_db:.1f}✗", BAD)
    if link.spare_db < TIGHT_DB:
        return Text(f"{link.spare_db:.1f}!", NOTE)
    return Text(f"{link.spare_db:.1f}", "yellow" if link.spare_db < SOME_DB else GOOD)


def network(state: FlightState) -> Text:
    """Whether all are linked, which links of the topology are down, and the weakest that holds."""
    text = Text()
    if len(state.uavs) == 1:
        return text.append("fleet of one: no links", SOFT)
    if state.parts == 1:
        text.append("✓ all linked", GOOD)
    elif state.parts > 1:
        text.append(f"✗ in {state.parts} parts", BAD)
    else:
        landed = all(uav.phase == LANDED for uav in state.uavs)
        return text.append(
            "all down: links are no longer needed" if landed else "no links yet", SOFT
        )
    broken = state.broken
    if broken:
        a, b, _ = broken[0]
        more = f" and {len(broken) - 1} more" if len(broken) > 1 else ""
        over = " by way of others" if state.parts == 1 else ""
        text.append(f"{over}; ✗ {a}–{b}{more} down", BAD)
    weakest = state.weakest
    if weakest is not None:
        a, b, decibels = weakest
        text.append("   weakest ").append(f"{a}–{b} ")
        text.append_text(spare(LinkState(b, decibels))).append(" dB")
    return text


def troubles(uav: UavState, k_min: int) -> int:
    """How many things are amiss with a UAV."""
    share = uav.energy_share
    return (
        (uav.phase in {SILENT, UNHEARD})
        + (uav.phase in {FLYING, HOLDING} and uav.neighbours < k_min)
        + (uav.late_s is not None and uav.late_s > VERY_LATE_S)
        + (share is not None and share < LOW_SHARE)
        + any(link.spare_db < TIGHT_DB for link in uav.links)
    )


def left_out(uavs: Sequence[UavState], k_min: int) -> Text:
    """How many UAVs there was no room for."""
    amiss = [uav.id for uav in uavs if troubles(uav, k_min)]
    if amiss:
        return Text(f"and {len(uavs)} more, not all well: {', '.join(amiss)}", BAD)
    return Text(f"and {len(uavs)} more, all well", SOFT)


def fleet(state: FlightState) -> str:
    """How many do what: "6 flying, 2 holding"."""
    counts: dict[str, int] = {}
    for uav in state.uavs:
        counts[uav.phase] = counts.get(uav.phase, 0) + 1
    return ", ".join(f"{count} {phase}" for phase, count in counts.items())


def event(one: Event, lift_off_ns: int | None) -> Text:
    """One line: when, counted from lift-off, who, what."""
    at_s = None if lift_off_ns is None else (one.stamp_ns - lift_off_ns) / 1e9
    mark, style = (
        ("✗", BAD) if one.level >= ERROR else ("!", NOTE) if one.level >= WARN else ("·", "")
    )
    text = Text(f"{clock(at_s)} ", SOFT).append(f"{mark} ", style)
    if one.uav_id and not one.text.startswith(one.uav_id):
        text.append(f"{one.uav_id}: ", style)
    return text.append(one.text, style)
