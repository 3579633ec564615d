"""Fresh confirmations of browsers, which dangerous acts need: whoever holds a cookie alone has none."""

from robot_runtime.clock import Clock
from server.http.sign_in.identity import Identity
from server.platform.errors import ForbiddenError

CONFIRMED_SECONDS = 600.0
UNCONFIRMED = "unconfirmed"
"""The entry of an ASGI scope that says that a request was refused for lack of a confirmation."""


class UnconfirmedError(ForbiddenError):
    """Not allowed; a browser that has not confirmed for ten minutes gets the kind `confirmation`"""

    kind = "confirmation"

    def __init__(self) -> None:
        super().__init__(
            "This needs a fresh confirmation: this browser has neither signed in nor confirmed in the last "
            "ten minutes. Enter a new operator's code, from another operator or from "
            "`mucat pair --role operator` on the robot's computer."
        )


class Confirmations:
    """The last confirmation of each browser, by device, in s, steady clock.

    In memory only: a server that starts again asks everybody.
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._confirmed: dict[int, float] = {}

    def confirm(self, device: int) -> None:
        """Record that this browser has signed in or confirmed now."""
        self._confirmed = {device: when for device, when in self._confirmed.items() if self._fresh(when)}
        self._confirmed[device] = self._clock.now()

    def require(self, identity: Identity) -> None:
        """Check that a browser has confirmed lately. Programs and the shell need not: a token's scope was
        chosen, and the shell is the robot's own. Raise UnconfirmedError."""
        when = self._confirmed.get(identity.device)
        if identity.kind == "browser" and (when is None or not self._fresh(when)):
            raise UnconfirmedError

    def _fresh(self, when: float) -> bool:
        return self._clock.now() - when < CONFIRMED_SECONDS
