"""Which seat has the control of the robot: one at a time, or none."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from robot_runtime.clock import Clock
from robot_runtime.errors import Refused

ANSWER_SECONDS = 10.0
"""For which the holder may refuse a request; then it passes."""
REFUSED_SECONDS = 10.0
"""After a refusal, before the same seat may ask again."""


class NotInControl(Exception):  # noqa: N818 - it says what happened
    """Only who has control may do this; the text says who has it, and what to do."""


@dataclass(frozen=True, slots=True)
class Waiting:
    """A seat, and until when it waits (s, steady clock)."""

    seat: int
    until: float


What = Literal["taken", "asked", "withdrawn", "refused", "handed", "passed", "released", "left"]
Changed = Callable[[What, int | None, int | None], None]
"""Told what has happened, to which seat (None: nobody has control now), and who had control until then."""


class Lease:
    """`epoch` grows by one with every change of the holder; what carries an older one no longer counts."""

    def __init__(self, clock: Clock, epoch: int, changed: Changed) -> None:
        self.epoch = epoch
        self.holder: int | None = None
        self.request: Waiting | None = None
        """Who has asked for the control; only ever while somebody else has it."""
        self._refused: dict[int, float] = {}
        self._clock = clock
        self._changed = changed

    @property
    def refused(self) -> Waiting | None:
        """Who was refused last, and until when that seat may not ask again."""
        return Waiting(*next(reversed(self._refused.items()))) if self._refused else None

    def take(self, seat: int) -> None:
        """Have free control at once; ask for it where another seat has it. Raises Refused."""
        self.settle()
        if self.holder is None:
            self._pass_to(seat, "taken")
        elif seat != self.holder and (self.request is None or self.request.seat != seat):
            self._ask(seat)

    def refuse(self, seat: int) -> None:
        """The holder keeps it. Raises NotInControl; Refused where nobody has asked."""
        self._require(seat)
        if self.request is None:
            raise Refused("Nobody asks for control now.")
        refused = self.request.seat
        self._refused[refused] = self._clock.now() + REFUSED_SECONDS
        self.request = None
        self._changed("refused", refused, self.holder)

    def hand_over(self, seat: int, to: int) -> None:
        """The holder gives it to another seat. Raises NotInControl."""
        self._require(seat)
        if to != seat:
            self._pass_to(to, "handed")

    def release(self, seat: int) -> None:
        """Have it no longer, and ask for it no longer; who has asked gets it at once."""
        self._leave(seat, "released")

    def forget(self, seat: int) -> None:
        """The seat is no more; a request of its own passes to nobody, even where it would just now."""
        self._withdraw(seat)
        self._leave(seat, "left")
        self._refused.pop(seat, None)

    def settle(self) -> None:
        """Let come about what time has brought: a request that passes, a refusal that is over."""
        now = self._clock.now()
        if self.request is not None and self.request.until <= now:
            self._pass_to(self.request.seat, "passed")
        self._refused = {seat: until for seat, until in self._refused.items() if until > now}

    def next_moment(self) -> float | None:
        """s; when `settle` has something to do, where nothing else happens before."""
        moments = [*self._refused.values()]
        if self.request is not None:
            moments.append(self.request.until)
        return min(moments, default=None)

    def _ask(self, seat: int) -> None:
        if self.request is not None:
            raise Refused("Somebody else has asked for control already. Try again in a few seconds.")
        wait = self._refused.get(seat, 0.0) - self._clock.now()
        if wait > 0:
            raise Refused(f"Your request was refused. You may ask again in {wait:.0f} s.")
        self.request = Waiting(seat, self._clock.now() + ANSWER_SECONDS)
        self._changed("asked", seat, self.holder)

    def _withdraw(self, seat: int) -> None:
        if self.request is not None and self.request.seat == seat:
            self.request = None
            self._changed("withdrawn", seat, self.holder)

    def _leave(self, seat: int, how: What) -> None:
        self.settle()
        if seat != self.holder:
            self._withdraw(seat)
        elif self.request is None:
            self._pass_to(None, how)
        else:
            self._pass_to(self.request.seat, "passed")

    def _pass_to(self, seat: int | None, how: What) -> None:
        before = self.holder
        self.epoch += 1
        self.holder = seat
        self.request = None
        self._refused.clear()
        self._changed(how, seat, before)

    def _require(self, seat: int) -> None:
        self.settle()
        if seat != self.holder:
            raise NotInControl("You do not have control any more.")
