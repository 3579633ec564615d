"""The desk at which the robot is driven: its seats, who has the control, and what the driver sends.

Everybody hears of each change through `tell`, and `note` has it in a sentence, for the record. Roles count
here too: a viewer's seat never has the control.
"""

import asyncio
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any

from robot_runtime.clock import Clock
from robot_runtime.errors import Refused
from server.features.lease.clients import Seat, Seats
from server.features.lease.driving import Drive, Driving
from server.features.lease.lease import Lease, NotInControl, What
from server.features.lease.schemas import Asking, ControlState, Holder, RefusedSeat, Seated
from server.http.sign_in.identity import Identity

WORDS: dict[What, str] = {
    "taken": "{seat} took control.",
    "asked": "{seat} asked {holder} for control.",
    "withdrawn": "{seat} asks for control no longer.",
    "refused": "{holder} kept control, for which {seat} had asked.",
    "handed": "{holder} handed control over to {seat}.",
    "passed": "Control passed from {holder} to {seat}, who had asked for it.",
    "released": "{holder} gave control back. Nobody has it now.",
    "left": "{holder} left, and nobody has control now.",
}


class Desk:
    """`tell` gets `{op: "control", ...}`, `publish` the bytes of a driving command."""

    def __init__(
        self,
        clock: Clock,
        tell: Callable[[dict[str, Any]], None],
        publish: Callable[[bytes], None],
        note: Callable[[str], None],
    ) -> None:
        self.seats = Seats(clock)
        # The steady clock never runs back while the computer is up, and nobody changes the holder a thousand
        # times a second: so the first epoch of a restarted server is above all those of the last one.
        self.lease = Lease(clock, int(clock.now() * 1000), self._note)
        self.driving = Driving(clock, publish)
        self._clock = clock
        self._tell = tell
        self._write = note
        self._news = asyncio.Event()

    @contextmanager
    def page(self, identity: Identity) -> Iterator[Seat]:
        """A page's seat, which ends with its socket."""
        seat = self.seats.open_page(identity)
        self.announce()
        try:
            yield seat
        finally:
            self._close(seat)
            self.announce()

    def seat_program(self, identity: Identity) -> Seat:
        """A program's seat. Raises Refused where its device has too many."""
        seat = self.seats.open_program(identity)
        self._news.set()
        return seat

    def take(self, seat: Seat) -> None:
        """Have control, or ask for it. Raises Refused."""
        if seat.identity.role != "operator":
            raise Refused("Only operators can have control. An operator can make you one on the People page.")
        with self._changing():
            self.lease.take(seat.number)

    def release(self, seat: Seat) -> None:
        """Give control back, or ask for it no longer."""
        with self._changing():
            self.lease.release(seat.number)

    def refuse(self, seat: Seat) -> None:
        """Keep control against who asks for it. Raises NotInControl, Refused."""
        with self._changing():
            self.lease.refuse(seat.number)

    def hand_over(self, seat: Seat, to: int) -> None:
        """Give control to another operator's seat. Raises NotInControl, Refused."""
        with self._changing():
            other = self.seats.get(to)
            if other is None:
                raise Refused("That page or program is gone. Choose another.")
            if other.identity.role != "operator":
                raise Refused(f"{other.identity.name} is a viewer, and only operators can have control.")
            self.lease.hand_over(seat.number, to)

    def require(self, seat: Seat | None) -> None:
        """Raises NotInControl, in words for a person, where this seat has no control."""
        self.settle()
        holder = self._name(self.lease.holder)
        if holder is None:
            raise NotInControl("Nobody has control. Take control first.")
        if seat is None or seat.number != self.lease.holder:
            raise NotInControl(f"Control is with {holder}; ask for it.")

    def drive(self, seat: Seat, command: Drive) -> None:
        """Pass it on, or drop and count it."""
        self.settle()
        self.driving.take(command, self.lease.epoch if seat.number == self.lease.holder else None)

    def dismiss(self, device: int) -> None:
        """A device is signed out, or has another role: its seats are no more. It may come back for others."""
        for seat in self.seats.of(device):
            self._close(seat)
        self.announce()

    def state(self) -> ControlState:
        """Who has control, who asks for it, and who was refused last."""
        self.settle()
        holder, request, refused = self.lease.holder, self.lease.request, self.lease.refused
        name = self._name(holder)
        asking = None if request is None else self._name(request.seat)
        return ControlState(
            epoch=self.lease.epoch,
            holder=None if holder is None or name is None else Holder(seat=holder, name=name),
            request=None
            if request is None or asking is None
            else Asking(seat=request.seat, name=asking, until=request.until),
            refused=None if refused is None else RefusedSeat(seat=refused.seat, until=refused.until),
            seats=[_seated(seat) for seat in self.seats],
        )

    def settle(self) -> None:
        """Let come about what time has brought."""
        for seat in self.seats.over():
            self._close(seat)
        self.lease.settle()

    def announce(self) -> None:
        """Tell everybody, and whoever looks at the time."""
        self._tell({"op": "control", **self.state().model_dump()})
        self._news.set()

    async def run(self) -> None:
        """Let come about, for ever and on time, what only time brings."""
        while True:
            self.announce()
            self._news.clear()
            moments = [one for one in (self.lease.next_moment(), self.seats.next_moment()) if one is not None]
            left = max(0.0, min(moments) - self._clock.now()) if moments else None
            with suppress(TimeoutError):
                async with asyncio.timeout(left):
                    await self._news.wait()

    @contextmanager
    def _changing(self) -> Iterator[None]:
        self.settle()
        try:
            yield
        finally:
            self.announce()

    def _close(self, seat: Seat) -> None:
        self.lease.forget(seat.number)
        self.seats.close(seat.number)

    def _note(self, what: What, seat: int | None, holder: int | None) -> None:
        self._write(WORDS[what].format(seat=f"“{self._name(seat)}”", holder=f"“{self._name(holder)}”"))

    def _name(self, number: int | None) -> str | None:
        seat = None if number is None else self.seats.get(number)
        return None if seat is None else seat.identity.name


def _seated(seat: Seat) -> Seated:
    who = seat.identity
    return Seated(seat=seat.number, name=who.name, role=who.role, kind=who.kind)
