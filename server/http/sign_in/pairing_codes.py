"""Pairing codes, and the wait after wrong ones.

Both are in memory only: codes become invalid when the server ends.
"""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from hmac import compare_digest
from math import ceil

from robot_runtime.clock import Clock
from server.http.sign_in.identity import SHELL, Role
from server.http.sign_in.tokens import digest, make_code, normal_code
from server.platform.errors import ApiError, ForbiddenError

CODE_SECONDS = 600.0
CODES_MAX = 20
"""The greatest number of valid codes; a further one replaces the oldest."""
TRY_SECONDS = 1.0
"""From a wrong code to the next try of the same address. A longer wait could be caused by a stranger; and at
49 bits even a try a millisecond finds no code within its ten minutes."""
MANY, MANY_SECONDS = 3, 60.0
"""So many wrong codes within this time are told to the people on the pages."""


class WrongCodeError(ForbiddenError):
    """The code is not valid"""

    def __init__(self) -> None:
        super().__init__(
            "This code is not valid. A code works once, for ten minutes; "
            "`mucat pair` on the robot's computer prints another, or an operator makes one."
        )


class WrongConfirmationError(WrongCodeError):
    """The code is not valid, or does not confirm"""

    def __init__(self) -> None:
        super(WrongCodeError, self).__init__(
            "This code does not confirm. It takes a valid code for an operator that this browser has not "
            "made itself: from another operator, or from `mucat pair --role operator` on the robot's "
            "computer."
        )


class TooManyTriesError(ApiError):
    """A wrong code was tried a moment ago; Retry-After says how long to wait"""

    status = 429

    def __init__(self, seconds: float) -> None:
        wait = ceil(seconds)
        super().__init__(f"A wrong code was tried a moment ago. Try again in {wait} s.")
        self.headers = {"retry-after": str(wait)}


@dataclass(frozen=True, slots=True)
class _Code:
    digest: str
    role: Role
    expires: float
    maker: int


class PairingCodes:
    """The valid codes; times in s, steady clock."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._codes: deque[_Code] = deque(maxlen=CODES_MAX)
        self._wrong: deque[float] = deque(maxlen=MANY)
        self._waiting: dict[str, float] = {}
        """By address, when it may try again."""

    @property
    def any_valid(self) -> bool:
        """True while a code is valid."""
        self._forget_old()
        return bool(self._codes)

    @property
    def many_wrong(self) -> bool:
        """True shortly after many wrong codes."""
        return len(self._wrong) == MANY and self._wrong[0] > self._clock.now() - MANY_SECONDS

    def make(self, role: Role, maker: int = SHELL.device) -> str:
        """Return a new code, for one pairing in this role; `maker` is the device that asks for it."""
        code = make_code()
        self._codes.append(_Code(digest(normal_code(code)), role, self._clock.now() + CODE_SECONDS, maker))
        return code

    def discard(self, maker: int) -> None:
        """Make all codes of this device void: it may admit no others any more."""
        for code in [candidate for candidate in self._codes if candidate.maker == maker]:
            self._codes.remove(code)

    def use(self, typed: str, address: str) -> Role:
        """Return the role of a code, which is then void.

        Raise WrongCodeError, after which this address waits, and TooManyTriesError while it does.
        """
        return self._use(typed, address, lambda _: True, WrongCodeError())

    def confirm(self, typed: str, device: int, address: str) -> None:
        """Use up a code that confirms the user of this device: an operator's code from another device.

        Raise WrongConfirmationError, after which this address waits, and TooManyTriesError while it does.
        """

        def fits(code: _Code) -> bool:
            return code.role == "operator" and code.maker != device

        self._use(typed, address, fits, WrongConfirmationError())

    def _use(self, typed: str, address: str, fits: Callable[[_Code], bool], wrong: WrongCodeError) -> Role:
        now = self._clock.now()
        self._waiting = {client: until for client, until in self._waiting.items() if until > now}
        if (until := self._waiting.get(address)) is not None:
            raise TooManyTriesError(until - now)
        self._forget_old()
        typed_digest = digest(normal_code(typed))
        # Every code is compared in full, so that the time taken reveals nothing.
        matching = [code for code in self._codes if compare_digest(code.digest, typed_digest) and fits(code)]
        if not matching:
            self._wrong.append(now)
            self._waiting[address] = now + TRY_SECONDS
            raise wrong
        self._codes.remove(matching[0])
        return matching[0].role

    def _forget_old(self) -> None:
        now = self._clock.now()
        while self._codes and self._codes[0].expires <= now:
            self._codes.popleft()
