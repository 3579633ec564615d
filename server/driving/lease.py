"""The control lease: at most one client has control of the robot."""

from collections.abc import Callable
from typing import Literal

from robot_runtime.clock import Clock
from server.platform.errors import ApiError

Change = Literal["taken", "taken over", "released", "left"]
Changed = Callable[[Change, int | None, int | None], None]
"""Called with the change, the client that has control now (None: nobody), and the one that had it before."""


class NotInControlError(ApiError):
    """Control is with somebody else"""

    status = 423


class Lease:
    """`epoch` grows with every change of the holder; commands of an older epoch no longer count.

    It is at least the clock's time in ms: above every epoch that the runtime has ever accepted, also from a
    server before this one. The steady clock never runs back while the computer is up, and nobody changes the
    holder a thousand times a second.
    """

    def __init__(self, clock: Clock, changed: Changed) -> None:
        self._clock = clock
        self.epoch = int(clock.now() * 1000)
        self.holder: int | None = None
        self._changed = changed

    def take(self, client: int) -> None:
        """Give control to this client, also if another has it."""
        if client != self.holder:
            self._pass_to(client, "taken" if self.holder is None else "taken over")

    def release(self, client: int) -> None:
        """Free control if this client has it."""
        self._free(client, "released")

    def forget(self, client: int) -> None:
        """Free control if this client, which is gone, had it."""
        self._free(client, "left")

    def _free(self, client: int, change: Change) -> None:
        if client == self.holder:
            self._pass_to(None, change)

    def _pass_to(self, client: int | None, change: Change) -> None:
        before = self.holder
        self.epoch = max(self.epoch + 1, int(self._clock.now() * 1000))
        self.holder = client
        self._changed(change, client, before)
