"""Pairing codes, and the limits for wrong ones.

Both are in memory only: codes become invalid when the server ends.
"""

from collections import deque
from dataclasses import dataclass
from hmac import compare_digest
from math import ceil

from robot_runtime.clock import Clock
from server.http.sign_in.identity import Role
from server.http.sign_in.tokens import digest, make_code, normal_code
from server.platform.errors import ApiError, ForbiddenError

CODE_SECONDS = 600.0
CODES_MAX = 20
"""The greatest number of valid codes; a further one replaces the oldest."""
LIMITS = ((3, 60.0), (10, 3600.0))
"""Wrong codes within so many seconds. They are counted together, wherever they come from: an address proves
nothing."""


class WrongCodeError(ForbiddenError):
    """The code is not valid"""

    def __init__(self) -> None:
        super().__init__(
            "This code is not valid. A code works once, for ten minutes; "
            "`mucat pair` on the robot's computer prints another, or an operator makes one."
        )


class TooManyTriesError(ApiError):
    """Too many wrong codes; Retry-After says how long"""

    status = 429

    def __init__(self, seconds: float) -> None:
        wait = ceil(seconds)
        super().__init__(f"Too many wrong codes have been tried. Try again in {_in_words(wait)}.")
        self.headers = {"retry-after": str(wait)}


@dataclass(frozen=True, slots=True)
class _Code:
    digest: str
    role: Role
    expires: float


class PairingCodes:
    """The valid codes; times in s, steady clock."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._codes: deque[_Code] = deque(maxlen=CODES_MAX)
        self._wrong: deque[float] = deque(maxlen=max(count for count, _ in LIMITS))

    @property
    def any_valid(self) -> bool:
        """True while a code is valid."""
        self._forget_old()
        return bool(self._codes)

    @property
    def wait(self) -> float:
        """s until a code may be tried; 0 where it may now."""
        now = self._clock.now()
        return max(
            (self._wrong[-count] + seconds - now for count, seconds in LIMITS if len(self._wrong) >= count),
            default=0.0,
        )

    def make(self, role: Role) -> str:
        """A new code, for one pairing in this role."""
        code = make_code()
        self._codes.append(_Code(digest(normal_code(code)), role, self._clock.now() + CODE_SECONDS))
        return code

    def use(self, typed: str) -> Role:
        """The role of a code, which is then void.

        Raises WrongCodeError, which counts, and TooManyTriesError.
        """
        if (wait := self.wait) > 0:
            raise TooManyTriesError(wait)
        self._forget_old()
        typed_digest = digest(normal_code(typed))
        # Every code is compared in full, so that the time taken reveals nothing.
        found = [code for code in self._codes if compare_digest(code.digest, typed_digest)]
        if not found:
            self._wrong.append(self._clock.now())
            raise WrongCodeError
        self._codes.remove(found[0])
        return found[0].role

    def _forget_old(self) -> None:
        now = self._clock.now()
        while self._codes and self._codes[0].expires <= now:
            self._codes.popleft()


def _in_words(seconds: int) -> str:
    return f"{seconds} s" if seconds <= 90 else f"{ceil(seconds / 60)} minutes"
