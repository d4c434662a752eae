"""The flight as a state machine, without ROS: what is ordered when, and how it ends."""

from __future__ import annotations

import pytest

from jfto.flight.actions import Ask, Order, Tell
from jfto.flight.conductor import Conductor, Stage
from jfto.flight.fleet_status import FleetStatus, VehicleStatus
from jfto.flight.outcome import Ending
from jfto.flight.settings import ARM, UPLOAD, ConductSettings

PAD = VehicleStatus(linked=True, silent_s=0.5, armed=False, mode="GUIDED")
UP = VehicleStatus(linked=True, silent_s=0.5, armed=True, mode="AUTO")
BACK = VehicleStatus(linked=True, silent_s=0.5, armed=True, mode="RTL")
GONE = VehicleStatus(linked=False, silent_s=500.0, armed=True, mode="AUTO")


class Stand:
    """A conductor with a fleet of two whose clock the test moves."""

    def __init__(self, **settings: object) -> None:
        self.conductor = Conductor(ConductSettings(plan_s=100.0, **settings))
        self.now_s = 1000.0
        self.done: list[object] = []

    def see(
        self, first: VehicleStatus, second: VehicleStatus, after_s: float = 1.0, note: str = ""
    ) -> None:
        """Let time pass and look."""
        self.now_s += after_s
        uavs = {} if note else {"uav1": first, "uav2": second}
        self.conductor.step(FleetStatus(self.now_s, self.now_s, note, not note, uavs))
        self.done += self.conductor.actions()

    def answer(self, verb: str, *, success: bool = True, text: str = "fine.") -> None:
        self.conductor.answered(verb, success=success, text=text)
        self.done += self.conductor.actions()

    def flying(self) -> None:
        """From the first sight of both to the air."""
        self.see(PAD, PAD)
        self.answer("upload")
        self.answer("start")
        self.see(UP, UP)

    @property
    def orders(self) -> list[str]:
        return [each.verb for each in self.done if isinstance(each, Order)]

    @property
    def told(self) -> str:
        return " ".join(each.text for each in self.done if isinstance(each, Tell))


def test_what_is_waited_for_is_told_after_two_seconds() -> None:
    """Once per reason: first the bridge, then the vehicle that is silent."""
    stand = Stand()
    silent = VehicleStatus()
    for _ in range(3):
        stand.see(PAD, silent, note="the bridge has not reported yet")
    for _ in range(6):
        stand.see(PAD, silent)
    assert stand.told == "Waiting: the bridge has not reported yet. Waiting: uav2 not heard."


def test_a_flight_is_uploaded_started_and_over_when_all_are_down() -> None:
    """Nothing is ordered twice; the end needs both to be down."""
    stand = Stand()
    stand.see(PAD, PAD, note="opening its links")
    assert stand.orders == []
    stand.flying()
    stand.see(PAD, UP, after_s=60.0)
    assert stand.conductor.outcome is None
    stand.see(PAD, PAD)
    assert stand.orders == ["upload", "start"]
    assert stand.conductor.outcome is not None
    assert stand.conductor.outcome.ending == Ending.LANDED
    assert stand.conductor.outcome.good
    assert stand.conductor.outcome.flown


def test_a_look_that_is_older_than_the_start_is_no_landing() -> None:
    """Right after the start the last statuses still say disarmed."""
    stand = Stand()
    stand.see(PAD, PAD)
    stand.answer("upload")
    stand.answer("start")
    stand.see(PAD, PAD)
    assert stand.conductor.stage == Stage.FLY
    assert stand.conductor.outcome is None


@pytest.mark.parametrize(
    ("until", "orders", "words"),
    [(UPLOAD, ["upload"], "on board and verified"), (ARM, ["upload", "check"], "would arm")],
)
def test_a_dry_run_ends_before_anything_arms(until, orders, words) -> None:
    """Upload verifies missions, arm asks the gate as well; nobody is started."""
    stand = Stand(until=until)
    stand.see(PAD, PAD)
    stand.answer("upload")
    stand.answer("check")
    assert stand.orders == orders
    outcome = stand.conductor.outcome
    assert outcome is not None
    assert outcome.ending == Ending.DRY
    assert words in outcome.text
    assert "Nothing was armed" in outcome.text
    assert not outcome.flown


@pytest.mark.parametrize(("word", "orders"), [(True, ["start"]), (False, [])])
def test_the_operator_is_asked_once_every_check_has_passed(word, orders) -> None:
    """Start is ordered on the word alone."""
    stand = Stand(ask=True)
    stand.see(PAD, PAD)
    stand.answer("upload")
    stand.answer("check")
    assert [each for each in stand.done if isinstance(each, Ask)] == [Ask()]
    assert stand.orders == ["upload", "check"]
    stand.conductor.confirmed(yes=word)
    stand.see(PAD, PAD)
    assert stand.orders == ["upload", "check", *orders]
    assert (stand.conductor.outcome is None) == word


def test_a_refused_upload_ends_it_with_the_reason() -> None:
    """Fleet-atomic: nothing was armed, and the bridge's words are passed on."""
    stand = Stand()
    stand.see(PAD, PAD)
    stand.answer("upload", success=False, text="No vehicle is released: uav2 refused item 3.")
    assert stand.conductor.outcome is not None
    assert stand.conductor.outcome.ending == Ending.REFUSED
    expected = "No vehicle is released: uav2 refused item 3. Nothing was armed."
    assert stand.conductor.outcome.text == expected


def test_vehicles_that_are_not_heard_are_not_waited_for_without_end() -> None:
    """The line names them."""
    stand = Stand()
    stand.see(PAD, VehicleStatus())
    stand.see(PAD, VehicleStatus(), after_s=181.0)
    assert stand.conductor.outcome is not None
    assert "uav2 not heard. Nothing was armed." in stand.conductor.outcome.text


def test_an_order_without_answer_has_an_end() -> None:
    """An upload that nobody answers ends the run; a start that nobody answers turns home."""
    stand = Stand()
    stand.see(PAD, PAD)
    stand.see(PAD, PAD, after_s=301.0)
    assert stand.conductor.outcome is not None
    assert "upload: no answer within 300 s. Nothing was armed." in stand.conductor.outcome.text
    other = Stand()
    other.see(PAD, PAD)
    other.answer("upload")
    other.see(UP, UP, after_s=301.0)
    assert other.orders == ["upload", "start", "abort"]
    assert other.conductor.stage == Stage.HOME


def test_a_start_that_is_broken_off_is_followed_until_all_are_down() -> None:
    """One is in the air and called home: the end says why, and is no success."""
    stand = Stand()
    stand.see(PAD, PAD)
    stand.answer("upload")
    stand.see(UP, PAD)
    stand.answer("start", success=False, text="uav2 did not arm. Called home: uav1.")
    stand.answer("abort")
    stand.see(BACK, PAD, after_s=20.0)
    assert stand.conductor.outcome is None
    stand.see(PAD, PAD)
    outcome = stand.conductor.outcome
    assert outcome is not None
    assert outcome.ending == Ending.ABORTED
    assert "uav2 did not arm" in outcome.text
    assert not outcome.good


def test_a_start_that_nobody_rose_in_is_refused() -> None:
    """The gate held all: nothing to bring home, and nothing is ordered."""
    stand = Stand()
    stand.see(PAD, PAD)
    stand.answer("upload")
    stand.answer("start", success=False, text="No vehicle is armed. uav1: GPS fix is 1, needs 3.")
    stand.see(PAD, PAD, after_s=9.0)
    assert stand.orders == ["upload", "start"]
    assert stand.conductor.outcome is not None
    assert stand.conductor.outcome.ending == Ending.REFUSED
    assert "GPS fix is 1" in stand.conductor.outcome.text


def test_ctrl_c_before_the_start_arms_nothing() -> None:
    """The stage is named."""
    stand = Stand()
    stand.see(PAD, PAD)
    stand.conductor.interrupt()
    assert stand.conductor.outcome is not None
    assert stand.conductor.outcome.text == "Interrupted while uploading. Nothing was armed."
    assert stand.conductor.outcome.interrupted


def test_ctrl_c_in_flight_orders_home_and_follows_until_all_are_down() -> None:
    """Once is home; the run goes on until the last one is disarmed."""
    stand = Stand()
    stand.flying()
    stand.conductor.interrupt()
    stand.see(UP, UP)
    stand.answer("abort", text="uav1 returning, uav2 returning")
    stand.see(BACK, PAD, after_s=30.0)
    assert stand.conductor.outcome is None
    stand.see(PAD, PAD)
    outcome = stand.conductor.outcome
    assert stand.orders == ["upload", "start", "abort"]
    assert outcome is not None
    assert outcome.ending == Ending.ABORTED
    assert outcome.interrupted
    assert "All 2 vehicles are down" in outcome.text


def test_ctrl_c_again_leaves_them_on_their_way() -> None:
    """It says who is left."""
    stand = Stand()
    stand.flying()
    stand.conductor.interrupt()
    stand.see(BACK, PAD)
    stand.conductor.interrupt()
    outcome = stand.conductor.outcome
    assert outcome is not None
    assert outcome.ending == Ending.LEFT
    assert outcome.text.startswith("Left while uav1 was on the way home")


def test_home_is_ordered_again_until_all_obey() -> None:
    """An abort that failed is repeated after a while, for those who fly on."""
    stand = Stand()
    stand.flying()
    stand.conductor.interrupt()
    stand.answer("abort", success=False, text="uav2 did not answer.")
    stand.see(BACK, UP)
    stand.see(BACK, UP, after_s=5.0)
    stand.answer("abort")
    stand.see(BACK, BACK, after_s=6.0)
    assert stand.orders == ["upload", "start", "abort", "abort"]
    assert "uav2 did not answer. Ordering again." in stand.told


def test_a_flight_without_end_is_called_home() -> None:
    """1.5 times the plan and the way home: then home is ordered, and that has an end too."""
    stand = Stand()
    stand.flying()
    stand.see(UP, UP, after_s=751.0)
    assert stand.orders[-1] == "abort"
    stand.answer("abort")
    stand.see(UP, PAD, after_s=601.0)
    outcome = stand.conductor.outcome
    assert outcome is not None
    assert outcome.ending == Ending.LOST
    assert "uav1 not known to be down 600 s after home was ordered" in outcome.text


def test_a_vehicle_that_fell_silent_is_ordered_home_and_left_to_itself() -> None:
    """The other one lands: the run ends, and says who is not known to be down."""
    stand = Stand()
    stand.flying()
    stand.see(PAD, GONE, after_s=60.0)
    assert stand.orders[-1] == "abort"
    stand.answer("abort", success=False, text="uav2 does not answer.")
    stand.see(PAD, GONE)
    outcome = stand.conductor.outcome
    assert outcome is not None
    assert outcome.ending == Ending.LOST
    assert "1 of 2 vehicles are down; uav2 is left to its own failsafes." in outcome.text


def test_an_upload_is_repeated_when_the_bridge_died_in_it() -> None:
    """Its answer is lost, and missions may be uploaded twice."""
    stand = Stand()
    stand.see(PAD, PAD)
    stand.conductor.bridge_died()
    stand.see(PAD, PAD, note="opening its links")
    assert stand.orders == ["upload"]
    stand.see(PAD, PAD)
    assert stand.orders == ["upload", "upload"]
    assert stand.conductor.stage == Stage.UPLOAD


@pytest.mark.parametrize(
    ("first", "second", "stage", "last"),
    [
        (PAD, PAD, Stage.START, "start"),
        (UP, UP, Stage.FLY, "start"),
        (UP, PAD, Stage.HOME, "abort"),
    ],
)
def test_a_start_that_the_bridge_died_in_is_judged_by_what_is_seen(
    first, second, stage, last
) -> None:
    """Nobody armed: again. All fly: follow. Some armed: home, since nobody knows the rest."""
    stand = Stand()
    stand.see(PAD, PAD)
    stand.answer("upload")
    stand.conductor.bridge_died()
    stand.see(first, second, note="opening its links")
    stand.see(first, second)
    assert stand.conductor.stage == stage
    assert stand.orders[-1] == last


def test_a_bridge_that_dies_in_flight_changes_nothing() -> None:
    """Vehicles go on; when it is back the flight is followed to its end."""
    stand = Stand()
    stand.flying()
    stand.conductor.bridge_died()
    stand.see(UP, UP, note="opening its links")
    stand.see(PAD, PAD)
    assert stand.orders == ["upload", "start"]
    assert stand.conductor.outcome is not None
    assert stand.conductor.outcome.ending == Ending.LANDED


def test_a_graph_that_cannot_be_kept_up_ends_it() -> None:
    """Before the start nothing was armed; in flight the vehicles go on by themselves."""
    stand = Stand()
    stand.see(PAD, PAD)
    stand.conductor.gave_up("mavlink_bridge ended with status 2.")
    assert stand.conductor.outcome is not None
    assert stand.conductor.outcome.text.endswith("status 2. Nothing was armed.")
    other = Stand()
    other.flying()
    other.conductor.gave_up("mavlink_bridge was killed eight times.")
    assert other.conductor.outcome is not None
    assert other.conductor.outcome.ending == Ending.LOST


def test_a_key_is_an_order_to_all_in_flight_and_none_before() -> None:
    """Hold and go on leave the flight as it is; home and land are followed down."""
    stand = Stand()
    stand.see(PAD, PAD)
    stand.conductor.order("abort", "home")
    assert stand.orders == ["upload"]
    stand.answer("upload")
    stand.answer("start")
    stand.see(UP, UP)
    stand.conductor.order("pause", "hold")
    stand.see(UP, UP)
    assert stand.conductor.stage == Stage.FLY
    stand.conductor.order("land", "land where they are")
    assert stand.conductor.stage == Stage.HOME
    stand.see(UP, UP)
    stand.answer("land", success=False, text="uav2 does not answer.")
    stand.see(UP, UP, after_s=10.0)
    assert stand.orders == ["upload", "start", "pause", "land", "land"]
    stand.answer("land")
    stand.see(PAD, PAD, after_s=20.0)
    assert stand.conductor.outcome is not None
    assert stand.conductor.outcome.ending == Ending.ABORTED
    assert "By key: land where they are." in stand.conductor.outcome.text


def test_a_flight_that_is_taken_over_is_followed_and_nothing_is_started() -> None:
    """Whoever is in the air is followed down; whoever is down already has landed."""
    stand = Stand(resume=True)
    stand.see(UP, UP)
    stand.see(UP, UP, after_s=10.0)
    assert stand.conductor.stage == Stage.FLY
    stand.see(UP, PAD, after_s=30.0)
    stand.see(PAD, PAD, after_s=30.0)
    assert stand.orders == []
    assert stand.conductor.outcome is not None
    assert stand.conductor.outcome.ending == Ending.LANDED
    ended = Stand(resume=True)
    ended.see(PAD, PAD)
    ended.see(PAD, PAD, after_s=10.0)
    assert ended.conductor.outcome is not None
    assert "ended while nobody looked" in ended.conductor.outcome.text
    assert ended.conductor.outcome.flown


def test_a_streamed_fleet_is_on_its_plan_after_a_restart_in_the_start() -> None:
    """In GUIDED with a trajectory streamed to it a vehicle flies what was planned."""
    streamed = VehicleStatus(linked=True, silent_s=0.5, armed=True, mode="GUIDED", streamed=True)
    assert streamed.on_plan
    assert not VehicleStatus(linked=True, armed=True, mode="GUIDED").on_plan
    stand = Stand()
    stand.see(PAD, PAD)
    stand.answer("upload")
    stand.conductor.bridge_died()
    stand.see(streamed, streamed, after_s=5.0)
    assert stand.conductor.stage == Stage.FLY


def test_keys_that_do_not_fit_end_the_run_at_once() -> None:
    """Frames arrive, so nobody is "not heard": the reason is said, and nothing is armed."""
    stand = Stand()
    foreign = VehicleStatus(trouble="uav2: signs with another key than this station.")
    stand.see(PAD, foreign)
    assert stand.conductor.outcome is not None
    assert stand.conductor.outcome.ending == Ending.REFUSED
    assert stand.conductor.outcome.text == f"{foreign.trouble} Nothing was armed."
