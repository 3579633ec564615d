"""Hardware in the loop: the simulator's word goes on to the board, and its silence is noticed.

The board in the loop has no sensors. What they would show comes from the simulator, over a network, as the
bytes of a `Sense`; the board takes the newest. The fins' angles go back as topic `motor`, like everywhere.
"""

import logging
from collections.abc import Callable

from robot_runtime.clock import Clock
from robot_runtime.contract.documents import Event
from robot_runtime.contract.packets import Packet, Sense
from robot_runtime.contract.packets.layout import LayoutError

log = logging.getLogger(__name__)

SILENCE = 0.5
"""s without a word after which the simulator counts as lost; the board gives up after half of it."""


class HilFeed:
    """The runtime's end of it. `hear` may be called from any thread; `tick` runs with the control loop."""

    def __init__(self, clock: Clock, send: Callable[[Packet], object], tell: Callable[[Event], None]) -> None:
        self._clock = clock
        self._send = send
        self._tell = tell
        self._heard = float("-inf")
        self._told = False

    @property
    def present(self) -> bool:
        """Whether the simulator's last word is fresh."""
        return self._clock.now() - self._heard <= SILENCE

    @property
    def lost(self) -> bool:
        """Whether it was here, and is no more."""
        return self._heard > float("-inf") and not self.present

    def hear(self, data: bytes) -> None:
        """Pass on a word of the simulator's; what is no such word is dropped and logged."""
        try:
            word = Sense.from_bytes(data)
        except LayoutError as problem:
            log.warning("the simulator sent what is no Sense: %s", problem)
            return
        self._heard = self._clock.now()
        self._send(word)

    def tick(self) -> None:
        """Tell where the simulator came; that it is lost is a fault."""
        if self.present and not self._told:
            self._told = True
            now, text = self._clock.now(), "The simulator is here."
            self._tell(Event(time=now, kind="simulator", severity="info", text=text))
        elif not self.present:
            self._told = False

    def refusals(self) -> list[str]:
        """Why arming would be refused now."""
        if self.present:
            return []
        return [
            "There is no simulator. Start it with “mucat simulator --connect ...”, or on the System page."
        ]
