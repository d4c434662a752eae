"""The flight as a state machine: from the fleet's status and answers to what is to be done.

It knows no ROS and no clock of its own. Every state has an end in time, and every end says in one
line what happened and what state the vehicles are in.
"""

from __future__ import annotations

from enum import Enum

from jfto.flight.actions import ERROR, WARN, Action, Ask, Order, Tell
from jfto.flight.fleet_status import FleetStatus
from jfto.flight.outcome import Ending, Outcome
from jfto.flight.settings import ARM, UPLOAD, ConductSettings


class Stage(Enum):
    """Where the flight stands."""

    LINK = "linking"
    UPLOAD = "uploading"
    CHECK = "checking"
    CONFIRM = "waiting for the word"
    START = "starting"
    FLY = "flying"
    HOME = "going home"
    OVER = "over"


# Stages before which nothing has been told to arm.
_EARLY = (Stage.LINK, Stage.UPLOAD, Stage.CHECK, Stage.CONFIRM)
_HOME = "abort"
_VERBS = {Stage.UPLOAD: "upload", Stage.CHECK: "check", Stage.START: "start", Stage.HOME: _HOME}


class Conductor:
    """Feed `step` with the fleet's status, and `answered`, `confirmed`, `interrupt` and
    `bridge_died` as it happens; do what `actions` returns. `outcome` is there in the end.
    """

    def __init__(self, settings: ConductSettings) -> None:
        self.settings = settings
        self.stage = Stage.LINK
        self.outcome: Outcome | None = None
        self._fleet = FleetStatus(0.0, 0.0, "not started", planned=False)
        self._since: tuple[float, float] | None = None
        self._actions: list[Action] = []
        self._pending = ""
        self._ordered_s = self._again_s = 0.0
        self._lost_answer = False
        # How they are brought down: home, or landing where they are.
        self._down = _HOME
        self._interrupted = self._flown = False
        self._why = ""
        # What is waited for, and when to say so.
        self._awaited = ("", 0.0)
        # Who has been seen armed since the fleet was told to start.
        self._risen: set[str] = set()

    def actions(self) -> list[Action]:
        """What is to be done now, each once."""
        actions, self._actions = self._actions, []
        return actions

    def step(self, fleet: FleetStatus) -> None:
        """Look at the fleet; call it a few times a second."""
        self._fleet = fleet
        if self._since is None:
            self._since = (fleet.now_s, fleet.fleet_s)
        if self.stage not in _EARLY:
            self._risen |= {name for name, uav in fleet.uavs.items() if uav.linked and uav.armed}
        if self._pending and fleet.now_s - self._ordered_s > self._limit_s():
            self._overdue()
        elif self._lost_answer:
            self._go_on_after_a_restart()
        elif self.stage == Stage.LINK:
            self._link()
        elif self.stage == Stage.FLY:
            self._fly()
        elif self.stage == Stage.HOME:
            self._home()

    def answered(self, verb: str, *, success: bool, text: str) -> None:
        """An order's answer has come."""
        if verb != self._pending:
            return
        self._pending = ""
        if self.stage == Stage.HOME:
            if not success:
                self._tell(f"Not all obeyed yet: {text} Ordering again.", ERROR)
            return
        if success:
            self._actions.append(Tell(text, known=True))
            self._succeeded()
        elif self.stage == Stage.START:
            # A start that was broken off calls the others home; they are followed down.
            self._turn_home(f"The start was refused: {text}", order=not self._fleet.all_down)
        else:
            self._end(Ending.REFUSED, f"{text} Nothing was armed.")

    def confirmed(self, *, yes: bool) -> None:
        """The operator has given the word to arm, or has not."""
        if self.stage != Stage.CONFIRM:
            return
        if yes:
            self._enter(Stage.START)
        else:
            self._end(Ending.REFUSED, "The word was not given. Nothing was armed.")

    def interrupt(self) -> None:
        """The operator pressed Ctrl-C: home first, and at the second time out."""
        if self.outcome is not None:
            return
        self._interrupted = True
        if self.stage in _EARLY:
            self._end(Ending.REFUSED, f"Interrupted while {self.stage.value}. Nothing was armed.")
        elif self.stage == Stage.HOME:
            self._end(
                Ending.LEFT,
                f"Left while {self._up() or 'nobody'} was on the way home: that goes on by itself, "
                "and nobody follows it.",
            )
        else:
            self._turn_home("Ctrl-C: home was ordered, and the fleet is followed until it is down.")

    def order(self, verb: str, words: str) -> None:
        """The operator gives an order to all in flight; `verb` is the bridge's service."""
        if self.stage not in (Stage.START, Stage.FLY, Stage.HOME):
            return
        if verb in (_HOME, "land"):
            self._down = verb
            self._turn_home(f"By key: {words}.")
        elif self.stage == Stage.FLY:
            # Its answer is told by the bridge.
            self._actions.append(Order(verb))

    def bridge_died(self) -> None:
        """The bridge's process has ended and comes back: the answer of an order is lost."""
        if self._pending:
            self._lost_answer, self._pending = True, ""

    def gave_up(self, text: str) -> None:
        """A process that nothing goes on without cannot be kept up."""
        if self.outcome is not None:
            return
        if self.stage in _EARLY:
            self._end(Ending.REFUSED, f"{text} Nothing was armed.")
        else:
            self._end(
                Ending.LOST,
                f"{text} Vehicles in the air finish their missions and return by themselves.",
            )

    # --- stages

    def _link(self) -> None:
        fleet = self._fleet
        if self.settings.resume:
            self._take_over()
        elif fleet.all_linked and fleet.planned:
            self._tell(f"{len(fleet.uavs)} vehicles linked")
            self._enter(Stage.UPLOAD)
        elif troubles := [u.trouble for u in fleet.uavs.values() if u.trouble and not u.linked]:
            # Frames arrive, and no waiting makes the keys fit.
            self._end(Ending.REFUSED, f"{' '.join(troubles)} Nothing was armed.")
        elif self._wall_s() > self.settings.patience.link_s:
            why = f"Not linked within {self.settings.patience.link_s:.0f} s: {fleet.awaited}."
            self._end(Ending.REFUSED, f"{why} Nothing was armed.")
        elif fleet.awaited != self._awaited[0]:
            self._awaited = (fleet.awaited, fleet.now_s + self.settings.patience.tell_s)
        elif fleet.now_s >= self._awaited[1]:
            self._awaited = (fleet.awaited, float("inf"))
            self._tell(f"Waiting: {fleet.awaited}.")

    def _take_over(self) -> None:
        """A flight is under way, or was: follow it, or say that it has ended."""
        fleet, waited_s = self._fleet, self._wall_s()
        up = [name for name, uav in fleet.uavs.items() if uav.linked and uav.armed]
        known = fleet.all_linked or waited_s > self.settings.patience.link_s / 6
        if known and up and waited_s > self.settings.patience.settle_s:
            self._flown = True
            self._tell(f"The flight is taken over: {', '.join(up)} in the air.", WARN)
            self._enter(Stage.FLY)
            self._risen |= set(up)
        elif fleet.all_down and waited_s > self.settings.patience.settle_s:
            self._flown = True
            self._end(Ending.LANDED, "All vehicles are down: the flight ended while nobody looked.")
        elif waited_s > self.settings.patience.link_s:
            self._flown = True
            self._end(Ending.LOST, f"{self._up()} not heard. Look for them.")

    def _succeeded(self) -> None:
        """The order of this stage was carried out."""
        until, stage = self.settings.until, self.stage
        if stage == Stage.UPLOAD and until == UPLOAD:
            self._end(Ending.DRY, "Missions are on board and verified. Nothing was armed.")
        elif stage == Stage.UPLOAD and (until == ARM or self.settings.ask):
            self._enter(Stage.CHECK)
        elif stage == Stage.CHECK and until == ARM:
            self._end(Ending.DRY, "The fleet would arm: every check passed. Nothing was armed.")
        elif stage == Stage.CHECK:
            self._enter(Stage.CONFIRM)
            self._actions.append(Ask())
        elif stage == Stage.UPLOAD:
            self._enter(Stage.START)
        elif stage == Stage.START:
            self._enter(Stage.FLY)

    def _fly(self) -> None:
        if self._everybody_ended():
            gone = self._up()
            if gone:
                self._turn_home(
                    f"{gone} silent for {self.settings.lost_s:.0f} s: home was ordered."
                )
            else:
                self._land()
        elif self._over_time(self.settings.flight_s):
            self._turn_home(
                f"{self._up()} did not land within {self.settings.flight_s:.0f} s: home was "
                "ordered."
            )

    def _home(self) -> None:
        fleet = self._fleet
        if self._everybody_ended() and not self._pending:
            self._land()
        elif self._over_time(self.settings.home_s):
            self._end(
                Ending.LOST,
                f"{self._why} {self._up()} not known to be down {self.settings.home_s:.0f} s "
                "after home was ordered. Look for them; jfto mission order return calls again.",
            )
        elif not self._pending and fleet.now_s >= self._again_s and self._needs_home():
            self._order(self._down)

    def _land(self) -> None:
        """Nobody flies any more whose link is up: say who is down and who is silent."""
        gone, count = self._up(), len(self._fleet.uavs)
        down = sum(uav.down for uav in self._fleet.uavs.values())
        if gone:
            text = f"{self._why} {down} of {count} vehicles are down; {gone} is left to its own"
            self._end(Ending.LOST, f"{text} failsafes.".strip())
        elif not self._risen:
            self._end(Ending.REFUSED, f"{self._why} Nobody flew, and all are disarmed.".strip())
        elif self._why:
            self._end(Ending.ABORTED, f"{self._why} All {down} vehicles are down and disarmed.")
        else:
            self._end(Ending.LANDED, f"All {down} vehicles are down and disarmed.")

    # --- when things go wrong

    def _overdue(self) -> None:
        verb, self._pending = self._pending, ""
        text = f"{verb}: no answer within {self._limit_s(verb):.0f} s."
        if verb in (_HOME, "land"):
            self._again_s = self._fleet.now_s
            self._tell(f"{text} Ordering home again.", ERROR)
        elif self.stage == Stage.START:
            self._turn_home(f"{text} Home was ordered.")
        else:
            self._end(Ending.REFUSED, f"{text} Nothing was armed.")

    def _go_on_after_a_restart(self) -> None:
        """The bridge is up again: repeat what can be repeated, find out what else was done."""
        fleet = self._fleet
        if not fleet.all_linked:
            if self._wall_s() > self.settings.patience.link_s + self.settings.patience.order_s:
                self._lost_answer = False
                self.gave_up("The bridge died and did not find all vehicles again.")
            return
        self._lost_answer = False
        verb = _VERBS[self.stage]
        if self.stage != Stage.START or fleet.all_down:
            self._tell(f"The bridge died during {verb}; it is back, and {verb} is repeated.", WARN)
            self._order(verb)
        elif all(uav.on_plan for uav in fleet.uavs.values()):
            self._tell("The bridge died during the start; it is back, and all fly.", WARN)
            self._enter(Stage.FLY)
        else:
            self._turn_home("The bridge died during the start, with some armed: home was ordered.")

    def _turn_home(self, why: str, *, order: bool = True) -> None:
        self._why = self._why or why
        if why:
            self._tell(why, WARN)
        self._pending, self._lost_answer = "", False
        self._enter(Stage.HOME)
        if order:
            self._order(self._down)

    def _needs_home(self) -> bool:
        """Whether somebody whose link is up flies and is not on the way home or down."""
        return any(
            uav.linked and uav.armed and uav.mode not in {"RTL", "LAND", "SMART_RTL"}
            for uav in self._fleet.uavs.values()
        )

    # --- what all of them use

    def _enter(self, stage: Stage) -> None:
        self.stage = stage
        self._since = (self._fleet.now_s, self._fleet.fleet_s)
        self._flown |= stage == Stage.START
        if stage in _VERBS and stage != Stage.HOME:
            self._order(_VERBS[stage])

    def _order(self, verb: str) -> None:
        self._pending, self._ordered_s = verb, self._fleet.now_s
        self._again_s = self._fleet.now_s + self.settings.patience.again_s
        self._actions.append(Order(verb))

    def _tell(self, text: str, level: int = 20) -> None:
        self._actions.append(Tell(text, level))

    def _end(self, ending: Ending, text: str) -> None:
        self.stage, self._pending = Stage.OVER, ""
        self.outcome = Outcome(ending, text, self._interrupted, self._flown)

    def _everybody_ended(self) -> bool:
        """Whether everybody is down, or silent for so long that nobody waits any more.

        Right after an order the status may be older than the order.
        """
        fleet = self._fleet
        if fleet.note or not fleet.uavs:
            return False
        settled = self._wall_s() > self.settings.patience.settle_s
        return all(
            (uav.down and (settled or name in self._risen)) or uav.silent_s > self.settings.lost_s
            for name, uav in fleet.uavs.items()
        )

    def _up(self) -> str:
        """Who is not known to be down, "" if all are."""
        return ", ".join(name for name, uav in self._fleet.uavs.items() if not uav.down)

    def _wall_s(self) -> float:
        return self._fleet.now_s - (self._since or (self._fleet.now_s, 0.0))[0]

    def _fleet_s(self) -> float:
        return self._fleet.fleet_s - (self._since or (0.0, self._fleet.fleet_s))[1]

    def _over_time(self, fleet_s: float) -> bool:
        return self._fleet_s() > fleet_s or self._wall_s() > self.settings.wall_s(fleet_s)

    def _limit_s(self, verb: str = "") -> float:
        patience = self.settings.patience
        down = (verb or self._pending) in (_HOME, "land")
        return patience.abort_s if down else patience.order_s
