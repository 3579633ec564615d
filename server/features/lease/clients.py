"""Seats: the pages and programs that could have the control. Whoever has paired may have several."""

import secrets
from collections.abc import Iterator
from dataclasses import dataclass

from robot_runtime.clock import Clock
from robot_runtime.errors import Refused
from server.http.sign_in.identity import Identity

PROGRAM_SECONDS = 10.0
"""A program's seat lasts so long after its last use."""
PROGRAMS_MAX = 20
"""Seats that the programs of one device may have at a time."""


@dataclass(slots=True)
class Seat:
    """One page or program; `key` is its secret, `until` when it ends (s), None for a page's."""

    number: int
    identity: Identity
    key: str
    until: float | None


class Seats:
    """Those that there are, by number; no number is ever given again."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._seats: dict[int, Seat] = {}
        self._last = 0

    def __iter__(self) -> Iterator[Seat]:
        return iter([*self._seats.values()])

    def open_page(self, identity: Identity) -> Seat:
        """For a page, until it is closed."""
        return self._open(identity, None)

    def open_program(self, identity: Identity) -> Seat:
        """For a program, as long as it is used. Raises Refused where the device has too many."""
        now = self._clock.now()
        others = [one for one in self.of(identity.device) if one.until is not None and one.until > now]
        if len(others) >= PROGRAMS_MAX:
            raise Refused(
                f"{PROGRAMS_MAX} programs of {identity.name} have seats already. "
                f"Wait until one has been silent for {PROGRAM_SECONDS:g} s."
            )
        return self._open(identity, now + PROGRAM_SECONDS)

    def use(self, identity: Identity, key: str) -> Seat | None:
        """The seat of this key, which now lasts on; None where this device has no such seat (any more)."""
        found = None
        for seat in self.of(identity.device):
            # Every key is looked at, whichever it is.
            if secrets.compare_digest(seat.key.encode(), key.encode()):
                found = seat
        now = self._clock.now()
        if found is None or (found.until is not None and found.until <= now):
            return None
        if found.until is not None:
            found.until = now + PROGRAM_SECONDS
        return found

    def get(self, number: int) -> Seat | None:
        """The seat of this number."""
        return self._seats.get(number)

    def of(self, device: int) -> list[Seat]:
        """Those of one device."""
        return [seat for seat in self._seats.values() if seat.identity.device == device]

    def close(self, number: int) -> None:
        """It is no more, if it was."""
        self._seats.pop(number, None)

    def over(self) -> list[Seat]:
        """Programs' seats that have not been used for too long."""
        now = self._clock.now()
        return [seat for seat in self if seat.until is not None and seat.until <= now]

    def next_moment(self) -> float | None:
        """s; when the next seat will be over, where it is not used before."""
        return min((seat.until for seat in self if seat.until is not None), default=None)

    def _open(self, identity: Identity, until: float | None) -> Seat:
        self._last += 1
        seat = Seat(self._last, identity, secrets.token_urlsafe(24), until)
        self._seats[seat.number] = seat
        return seat
