"""Any sequence of what people, programs and time can do at the desk, against what must always hold."""

from contextlib import AbstractContextManager

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    Bundle,
    MultipleResults,
    RuleBasedStateMachine,
    consumes,
    initialize,
    invariant,
    multiple,
    precondition,
    rule,
)

from robot_runtime.errors import Refused
from server.features.lease.clients import Seat
from server.features.lease.lease import ANSWER_SECONDS, NotInControl, Waiting, What
from server.http.sign_in.identity import Identity, Role
from tests.server.features.lease.people import Seen

PEOPLE = 4


class AtTheDesk(RuleBasedStateMachine):
    """Remembers what was refused, handed over and lost, and compares."""

    seats = Bundle("seats")

    def __init__(self) -> None:
        super().__init__()
        self.seen = Seen()
        self.desk = self.seen.desk
        self.roles: dict[int, Role] = {device: "operator" if device else "viewer" for device in range(PEOPLE)}
        self.pages: dict[int, AbstractContextManager[Seat]] = {}
        self.asked: dict[int, float] = {}
        self.epoch, self.holder = self.desk.lease.epoch, self.desk.lease.holder
        self.noted: int | None = None
        self.write = self.desk.lease._changed
        self.desk.lease._changed = self.note

    def note(self, what: What, seat: int | None, holder: int | None) -> None:
        """Each note begins where the last one has ended."""
        assert holder == self.noted
        if what not in ("asked", "withdrawn", "refused"):
            self.noted = seat
        self.write(what, seat, holder)

    def identity(self, device: int) -> Identity:
        return Identity(device, f"Person {device}", self.roles[device], "browser")

    @initialize(target=seats)
    def begin(self) -> MultipleResults[Seat]:
        """Everybody has a page open, and the last one control."""
        here = [self.open(device, False) for device in range(PEOPLE)]
        self.desk.take(here[-1])
        return multiple(*here)

    @rule(target=seats, device=st.integers(0, PEOPLE - 1), program=st.booleans())
    def come(self, device: int, program: bool) -> Seat:
        """A page is opened, or a program begins."""
        return self.open(device, program)

    def open(self, device: int, program: bool) -> Seat:
        identity = self.identity(device)
        if program:
            return self.desk.seat_program(identity)
        page = self.desk.page(identity)
        seat = page.__enter__()
        self.pages[seat.number] = page
        return seat

    @rule(seat=consumes(seats))
    def go(self, seat: Seat) -> None:
        """A page is closed; a program is silent from now on."""
        if seat.until is None:
            self.pages.pop(seat.number).__exit__(None, None, None)
            assert self.desk.seats.get(seat.number) is None
            assert self.desk.lease.holder != seat.number

    @rule(seat=seats)
    def take(self, seat: Seat) -> None:
        alive = self.desk.seats.use(seat.identity, seat.key)
        if alive is None:
            return
        free, refused = self.desk.lease.holder is None, dict(self.desk.lease._refused)
        try:
            self.desk.take(alive)
        except Refused:
            other = self.desk.lease.request is not None
            assert seat.identity.role == "viewer" or other or seat.number in refused
            assert not (free and seat.identity.role == "operator")
            return
        assert seat.identity.role == "operator"
        if free:
            assert self.desk.lease.holder == seat.number
        elif self.desk.lease.request is not None:
            assert seat.number not in refused
            self.asked.setdefault(seat.number, self.seen.clock.now())

    @precondition(lambda self: self.desk.lease.request is not None)
    @rule()
    def answer(self) -> None:
        """The holder refuses, whoever that is."""
        holder = self.desk.seats.get(self.desk.lease.holder or 0)
        assert holder is not None
        self.refuse(holder)

    @precondition(lambda self: self.desk.lease.refused is not None)
    @rule()
    def insist(self) -> None:
        """Who was refused asks again too soon."""
        refused = self.desk.lease.refused
        assert refused is not None
        seat = self.desk.seats.get(refused.seat)
        assert seat is not None
        with pytest.raises(Refused):
            self.desk.take(seat)

    @rule(seat=seats)
    def refuse(self, seat: Seat) -> None:
        request = self.desk.lease.request
        try:
            self.desk.refuse(seat)
        except (NotInControl, Refused):
            return
        assert request is not None
        assert self.desk.lease.holder == seat.number
        del self.asked[request.seat]

    @rule(seat=seats, to=seats)
    def hand_over(self, seat: Seat, to: Seat) -> None:
        try:
            self.desk.hand_over(seat, to.number)
        except (NotInControl, Refused):
            return
        assert self.desk.lease.holder == to.number

    @rule(seat=seats)
    def release(self, seat: Seat) -> None:
        self.desk.release(seat)
        assert self.desk.lease.holder != seat.number

    @rule(seat=seats)
    def drive(self, seat: Seat) -> None:
        before = len(self.seen.driven)
        self.desk.drive(seat, self.seen.drive(sequence=len(self.seen.told)))
        if len(self.seen.driven) > before:
            assert self.desk.lease.holder == seat.number

    @rule(seconds=st.sampled_from([0.01, 1.0, 3.0, 9.99, 10.0, 30.0]))
    def wait(self, seconds: float) -> None:
        self.seen.clock.forward(seconds)
        self.desk.settle()

    @rule(device=st.integers(0, PEOPLE - 1), role=st.sampled_from(["viewer", "operator"]))
    def change_role(self, device: int, role: Role) -> None:
        """Which ends everything that it had before, as a sign-out does."""
        self.roles[device] = role
        self.desk.dismiss(device)
        assert self.desk.seats.of(device) == []

    @invariant()
    def at_most_one_operator_who_is_there_has_it(self) -> None:
        self.desk.settle()
        holder = self.desk.lease.holder
        if holder is not None:
            seat = self.desk.seats.get(holder)
            assert seat is not None
            assert seat.identity.role == "operator"
            assert seat.until is None or seat.until > self.seen.clock.now()

    @invariant()
    def the_epoch_grows_with_every_change_and_with_nothing_else(self) -> None:
        lease = self.desk.lease
        assert lease.epoch >= self.epoch
        if lease.holder != self.holder:
            assert lease.epoch > self.epoch
        self.epoch, self.holder = lease.epoch, lease.holder

    @invariant()
    def who_reads_the_notes_knows_who_has_it(self) -> None:
        assert self.noted == self.desk.lease.holder
        assert "“None”" not in "".join(self.seen.noted)

    @invariant()
    def who_asks_is_there_and_is_not_the_holder_and_waits_no_longer_than_said(self) -> None:
        lease, now = self.desk.lease, self.seen.clock.now()
        self.asked = {seat: at for seat, at in self.asked.items() if lease.request == _until(seat, at)}
        if lease.request is None:
            return
        assert lease.holder is not None
        assert lease.request.seat != lease.holder
        assert now < lease.request.until <= now + ANSWER_SECONDS
        assert self.asked
        seat = self.desk.seats.get(lease.request.seat)
        assert seat is not None
        assert seat.identity.role == "operator"

    @invariant()
    def who_was_refused_has_not_got_it_through_that(self) -> None:
        lease = self.desk.lease
        assert lease.refused is None or lease.refused.seat != lease.holder
        assert lease.request is None or lease.request.seat not in lease._refused


def _until(seat: int, asked: float) -> Waiting:
    return Waiting(seat, asked + ANSWER_SECONDS)


TestAtTheDesk = AtTheDesk.TestCase
TestAtTheDesk.settings = settings(max_examples=50, stateful_step_count=40, deadline=None)
