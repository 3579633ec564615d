"""The control lease: which client has the control of the robot, one at a time or none."""

from collections.abc import Callable
from typing import Literal

from server.platform.errors import ApiError

Change = Literal["taken", "taken over", "released", "left"]
Changed = Callable[[Change, int | None, int | None], None]
"""Called with the change, the client that has control now (None: nobody), and the one that had it before."""


class NotInControlError(ApiError):
    """Control is with somebody else"""

    status = 423


class Lease:
    """`epoch` grows by one with every change of the holder; what carries an older one no longer counts."""

    def __init__(self, epoch: int, changed: Changed) -> None:
        self.epoch = epoch
        self.holder: int | None = None
        self._changed = changed

    def take(self, client: int) -> None:
        """Give control to this client, whatever client has it."""
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
        self.epoch += 1
        self.holder = client
        self._changed(change, client, before)
