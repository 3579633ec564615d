"""Hardware in the loop: forwards the simulator's messages to the board and detects their absence.

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
    """Forwards simulated sensors. `hear` may be called from any thread; `tick` runs with the control loop."""

    def __init__(
        self, clock: Clock, send: Callable[[Packet], object], on_event: Callable[[Event], None]
    ) -> None:
        self._clock = clock
        self._send = send
        self._on_event = on_event
        self._heard = float("-inf")
        self._reported = False

    @property
    def present(self) -> bool:
        """True if the simulator's last message is fresh."""
        return self._clock.now() - self._heard <= SILENCE

    @property
    def lost(self) -> bool:
        """True if the simulator was connected and no longer is."""
        return self._heard > float("-inf") and not self.present

    def hear(self, data: bytes) -> None:
        """Forwards a message of the simulator; an invalid one is dropped and logged."""
        try:
            word = Sense.from_bytes(data)
        except LayoutError as problem:
            log.warning("the simulator sent what is no Sense: %s", problem)
            return
        self._heard = self._clock.now()
        self._send(word)

    def tick(self) -> None:
        """Publishes an event when the simulator connects; its loss is a fault."""
        if self.present and not self._reported:
            self._reported = True
            now, text = self._clock.now(), "The simulator is here."
            self._on_event(Event(time=now, kind="simulator", severity="info", text=text))
        elif not self.present:
            self._reported = False

    def refusals(self) -> list[str]:
        """Returns the reasons against arming now."""
        if self.present:
            return []
        return [
            "There is no simulator. Start it with “mucat simulator --connect ...”, or on the System page."
        ]
