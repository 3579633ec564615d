"""The control lease under any sequence of events of people, programs and time, against its invariants."""

from contextlib import AbstractContextManager

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
    rule,
)

from robot_runtime.errors import RefusedError
from server.driving.clients import ControlClient
from server.driving.lease import Change
from server.http.sign_in.identity import Identity, Role
from tests.server.driving.people import ArbiterRig

PEOPLE = 4
PROGRAMS = 10
"""Added to a person's device: that of the person's programs."""


class Contest(RuleBasedStateMachine):
    """A model of the lease: remembers the holder, and compares."""

    clients = Bundle("clients")

    def __init__(self) -> None:
        super().__init__()
        self.seen = ArbiterRig()
        self.arbiter = self.seen.arbiter
        self.roles: dict[int, Role] = {device: "operator" if device else "viewer" for device in range(PEOPLE)}
        self.pages: dict[int, AbstractContextManager[ControlClient]] = {}
        self.epoch, self.holder = self.arbiter.lease.epoch, self.arbiter.lease.holder
        self.noted: int | None = None
        self.write = self.arbiter.lease._changed
        self.arbiter.lease._changed = self.note

    def note(self, change: Change, client: int | None, holder: int | None) -> None:
        """Check that each note begins where the last one has ended."""
        assert holder == self.noted
        assert (change == "taken over") is (client is not None and holder is not None)
        self.noted = client
        self.write(change, client, holder)

    def alive(self, client: ControlClient) -> bool:
        """Return True while requests of this client still name it; a program's requests extend its lease."""
        key = client.key or None
        return self.arbiter.clients.find(client.identity, key) is client

    @initialize(target=clients)
    def begin(self) -> MultipleResults[ControlClient]:
        """Open a page for every person; the last one has control."""
        here = [self.open(device, False) for device in range(PEOPLE)]
        self.arbiter.take(here[-1])
        return multiple(*here)

    @rule(target=clients, device=st.integers(0, PEOPLE - 1), program=st.booleans())
    def come(self, device: int, program: bool) -> ControlClient:
        """Open a page, or begin a program."""
        return self.open(device, program)

    def open(self, device: int, program: bool) -> ControlClient:
        if program:
            name = f"Program of {device}"
            identity = Identity(PROGRAMS + device, name, self.roles[device], "program")
            return self.arbiter.open_program(identity)
        page = self.arbiter.page(Identity(device, f"Person {device}", self.roles[device], "browser"))
        client = page.__enter__()
        self.pages[client.number] = page
        return client

    @rule(client=consumes(clients))
    def go(self, client: ControlClient) -> None:
        """A page is closed; a program sends nothing from now on."""
        if client.until is None:
            self.pages.pop(client.number).__exit__(None, None, None)
            assert self.arbiter.clients.get(client.number) is None
            assert self.arbiter.lease.holder != client.number

    @rule(client=clients, over=st.booleans())
    def take(self, client: ControlClient, over: bool) -> None:
        if not self.alive(client):
            return
        before = self.arbiter.lease.holder
        try:
            self.arbiter.take(client, over=over)
        except RefusedError:
            assert self.arbiter.lease.holder == before
            held = before is not None and before != client.number
            assert client.identity.role == "viewer" or (held and not over)
            return
        assert client.identity.role == "operator"
        assert self.arbiter.lease.holder == client.number

    @rule(client=clients)
    def release(self, client: ControlClient) -> None:
        self.arbiter.release(client)
        assert self.arbiter.lease.holder != client.number

    @rule(client=clients)
    def drive(self, client: ControlClient) -> None:
        before = len(self.seen.driven)
        self.arbiter.drive(client, self.seen.drive(sequence=len(self.seen.messages)))
        if len(self.seen.driven) > before:
            assert self.arbiter.lease.holder == client.number

    @rule(seconds=st.sampled_from([0.01, 1.0, 3.0, 9.99, 10.0, 30.0]))
    def wait(self, seconds: float) -> None:
        self.seen.clock.forward(seconds)
        self.arbiter.expire()

    @rule(device=st.integers(0, PEOPLE - 1), role=st.sampled_from(["viewer", "operator"]))
    def change_role(self, device: int, role: Role) -> None:
        """A changed role dismisses the device's clients, as a sign-out does."""
        self.roles[device] = role
        for number in (device, PROGRAMS + device):
            self.arbiter.dismiss(number)
            assert self.arbiter.clients.of(number) == []

    @invariant()
    def at_most_one_operator_who_is_there_has_it(self) -> None:
        self.arbiter.expire()
        holder = self.arbiter.lease.holder
        if holder is not None:
            client = self.arbiter.clients.get(holder)
            assert client is not None
            assert client.identity.role == "operator"
            assert client.until is None or client.until > self.seen.clock.now()

    @invariant()
    def the_programs_of_a_token_are_one_client(self) -> None:
        for device in range(PROGRAMS, PROGRAMS + PEOPLE):
            assert len(self.arbiter.clients.of(device)) <= 1

    @invariant()
    def the_epoch_grows_with_every_change_and_with_nothing_else(self) -> None:
        lease = self.arbiter.lease
        assert lease.epoch >= self.epoch
        if lease.holder != self.holder:
            assert lease.epoch > self.epoch
        self.epoch, self.holder = lease.epoch, lease.holder

    @invariant()
    def who_reads_the_notes_knows_who_has_it(self) -> None:
        assert self.noted == self.arbiter.lease.holder
        assert "“None”" not in "".join(self.seen.noted)


TestContest = Contest.TestCase
TestContest.settings = settings(max_examples=50, stateful_step_count=40, deadline=None)
