"""Hardware in the loop: forwards the simulator's messages to the board and detects their absence.

The board in the loop has no sensors. Their readings come from the simulator, over a network, as the bytes of
a `Sense`; the board uses the newest. The fins' angles go back as topic `motor`.
"""

import logging
from collections.abc import Callable

from robot_runtime.clock import Clock
from robot_runtime.contract.documents import Event
from robot_runtime.contract.packets import Packet, Sense
from robot_runtime.contract.packets.layout import LayoutError

log = logging.getLogger(__name__)

SILENCE = 0.5
"""s without a message after which the simulator counts as lost; the board gives up after half of it."""


class HilFeed:
    """The feed of simulated sensor readings to the board.

    Any thread may call `forward`; `tick` runs under the supervisor's lock.
    """

    def __init__(
        self, clock: Clock, send: Callable[[Packet], object], on_event: Callable[[Event], None]
    ) -> None:
        self._clock = clock
        self._send = send
        self._on_event = on_event
        self._received = float("-inf")
        self._reported = False

    @property
    def present(self) -> bool:
        """True if the simulator's last message is fresh."""
        return self._clock.now() - self._received <= SILENCE

    @property
    def lost(self) -> bool:
        """True if the simulator was connected and no longer is."""
        return self._received > float("-inf") and not self.present

    def forward(self, data: bytes) -> None:
        """Forward a message of the simulator; an invalid one is dropped and logged."""
        try:
            sense = Sense.from_bytes(data)
        except LayoutError as problem:
            log.warning("the simulator sent an invalid Sense: %s", problem)
            return
        self._received = self._clock.now()
        self._send(sense)

    def tick(self) -> None:
        """Publish an event when the simulator connects; its loss is a fault."""
        if self.present and not self._reported:
            self._reported = True
            now, text = self._clock.now(), "The simulator is connected."
            self._on_event(Event(time=now, kind="simulator", severity="info", text=text))
        elif not self.present:
            self._reported = False

    def refusals(self) -> list[str]:
        """Return the reasons against arming now."""
        if self.present:
            return []
        return [
            "There is no simulator. Start it with “mucat simulator --connect ...”, or on the System page."
        ]
