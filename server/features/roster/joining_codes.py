"""Codes by which robots join a lab: a pairing code, and after it a part of the lab's fingerprint."""

import time

from robot_runtime.clock import Clock
from server.features.roster.schemas import MadeJoiningCode
from server.http.pinned_requests import PIN_LENGTH, pin_of
from server.http.sign_in.pairing_codes import CODE_SECONDS, PairingCodes, WrongCodeError
from server.platform.certificate import read_fingerprint
from server.platform.errors import ConflictError
from server.platform.settings import Settings


class WrongJoiningCodeError(WrongCodeError):
    """The code is not valid"""

    def __init__(self) -> None:
        super(WrongCodeError, self).__init__(
            "This code is not valid. A code works once, for ten minutes; the page Robots of the lab makes "
            "another, or `mucat lab pair` on its computer."
        )


class LabWithoutTlsError(ConflictError):
    """The lab's server has no certificate"""


class JoiningCodes:
    """The valid codes."""

    def __init__(self, settings: Settings, clock: Clock) -> None:
        self._settings = settings
        self._codes = PairingCodes(clock)

    def make(self, called: str) -> MadeJoiningCode:
        """Make a code for a lab that is called so by its page. Raise LabWithoutTlsError."""
        if not self._settings.server.tls:
            raise LabWithoutTlsError(
                "Robots join by a code only where they can tell this lab from another: set server.tls = true "
                "in its robot.toml, and start it again."
            )
        pin = pin_of(read_fingerprint(self._settings.data))
        code = f"{self._codes.make('operator')}-{pin[: PIN_LENGTH // 2]}-{pin[PIN_LENGTH // 2 :]}"
        address = self._settings.base_url(called)
        return MadeJoiningCode(
            code=code,
            address=address,
            command=f"mucat lab join {address} {code}",
            expires=time.time() + CODE_SECONDS,
        )

    def use(self, typed: str, address: str) -> None:
        """Use a code up. Raise WrongJoiningCodeError, TooManyTriesError."""
        try:
            self._codes.use(typed, address)
        except WrongCodeError:
            raise WrongJoiningCodeError from None
