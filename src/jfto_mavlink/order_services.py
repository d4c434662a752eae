"""Orders as they come to the bridge: each in a thread of its own, and all told how they went."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

from jfto_mavlink.fleet.orders import FleetOrders
from jfto_msgs_py.errors import JftoError
from jfto_msgs_py.records.event import ERROR, INFO, Event

UNDER_WAY, DONE, FAILED = "under way", "done", "failed"


@dataclass(frozen=True)
class OrderState:
    """An order, how far it is (UNDER_WAY, DONE or FAILED), and what came of it."""

    verb: str
    stage: str
    text: str = ""

    @property
    def event(self) -> Event | None:
        """What everybody is told; nothing of an order that is under way."""
        if self.stage == UNDER_WAY:
            return None
        text = " ".join(f"{self.verb}: {self.text}".split())
        return Event(INFO if self.stage == DONE else ERROR, "order", "", text)


class OrderServices:
    """`orders` are the fleet's, or why there are none yet; `news` hears of each step, in threads.

    What has come of orders that were given with `begin` is in `answers`.
    """

    def __init__(
        self, orders: Callable[[], FleetOrders | str], news: Callable[[OrderState], None]
    ) -> None:
        self._orders, self._news = orders, news
        self.answers: deque[tuple[object, bool, str]] = deque()

    def begin(self, verb: str, who: object) -> None:
        """Carry out an order in a thread; `who` stands for whoever wants the answer."""
        threading.Thread(target=self.obey, args=(verb, who), name=verb, daemon=True).start()

    def obey(self, verb: str, who: object = None) -> tuple[bool, str]:
        """Carry out an order now; whether that went well, and in words what was done or why not."""
        self._news(OrderState(verb, UNDER_WAY))
        try:
            orders = self._orders()
            success = not isinstance(orders, str)
            text = orders if isinstance(orders, str) else getattr(orders, verb)()
        except JftoError as error:
            success, text = False, str(error)
        except Exception as error:  # noqa: BLE001  whoever asked is told
            success, text = False, f"{type(error).__name__}: {error}"
        if who is not None:
            self.answers.append((who, success, text))
        self._news(OrderState(verb, DONE if success else FAILED, text))
        return success, text
