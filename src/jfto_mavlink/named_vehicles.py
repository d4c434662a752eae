"""The vehicles that the bridge's parameters name."""

from __future__ import annotations

from collections.abc import Sequence

from jfto_mavlink.errors import RosterError
from jfto_mavlink.fleet.roster import Roster, parse_roster
from jfto_mavlink.options import BridgeOptions

SIMULATED = "sim:"


def simulated_count(options: BridgeOptions) -> int | None:
    """N where the roster is sim:N, None for real vehicles; raises RosterError."""
    if not any(text.startswith(SIMULATED) for text in options.roster):
        return None
    number = options.roster[0].removeprefix(SIMULATED)
    if len(options.roster) != 1 or not number.isdecimal():
        raise RosterError(201, f"roster is {list(options.roster)}; simulated vehicles are sim:N.")
    if options.endpoints or options.key_file:
        raise RosterError(201, "simulated vehicles take neither endpoints nor a key_file.")
    return int(number)


def read_roster(options: BridgeOptions, uavs: Sequence[str]) -> Roster:
    """Roster of real vehicles; raises RosterError where it does not name exactly these UAVs."""
    texts = list(options.roster) or [f"{uav}={n}" for n, uav in enumerate(uavs, 1)]
    bare = [index for index, text in enumerate(texts) if "@" not in text]
    links = options.endpoints * len(bare) if len(options.endpoints) == 1 else options.endpoints
    if len(links) != len(bare):
        raise RosterError(
            201,
            f"{len(bare)} roster entries have no @LINK and endpoints has {len(options.endpoints)}; "
            "give one for all, or one each.",
        )
    for index, link in zip(bare, links, strict=True):
        texts[index] += f"@{link}"
    roster = parse_roster(texts)
    odd = set(roster.uavs) ^ set(uavs)
    if odd:
        raise RosterError(
            205, f"{', '.join(sorted(odd))}: in the fleet or in the roster, not both."
        )
    return roster
