"""The arbiter of control of the robot: one client has it, takes or releases it, and steers by its sticks.

A client takes control that is free, or takes it over from another one on purpose. With each change the
robot's sticks are neutral (`robot_runtime.control.pilot`). Viewers never have control.
"""

import asyncio
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import Any

from robot_runtime.clock import Clock
from robot_runtime.errors import RefusedError
from server.driving.clients import PROGRAM_SECONDS, ControlClient, ControlClients
from server.driving.drive_filter import DriveCommand, DriveFilter
from server.driving.lease import Change, Lease, NotInControlError
from server.driving.schemas import ControlState, Holder
from server.http.sign_in.identity import Identity

TEXTS: dict[Change, str] = {
    "taken": "{client} took control.",
    "taken over": "{client} took over control from {holder}.",
    "released": "{holder} released control. Nobody has it now.",
    "left": "{holder} left, and nobody has control now.",
}

RELOAD_SECONDS = 5.0
"""A page that reloads and takes control again within this time leaves no trace in the record."""


@dataclass(frozen=True, slots=True)
class Departure:
    """A page of `device` that closed while it had control; `text` enters the record at `due` (s)."""

    device: int
    text: str
    due: float


class ControlArbiter:
    """Arbiter of control: one client at a time has it and drives.

    `notify` gets `{op: "control", ...}` at each change, `publish` the bytes of a stick command, `note` a
    sentence about each change for the record, and `audit` who lost control without giving it back, and why.
    """

    def __init__(
        self,
        clock: Clock,
        notify: Callable[[dict[str, Any]], None],
        publish: Callable[[bytes], None],
        note: Callable[[str], None],
        audit: Callable[[Identity, str], None],
    ) -> None:
        self.clients = ControlClients(clock)
        self.lease = Lease(clock, self._note)
        self.driving = DriveFilter(clock, publish)
        self._clock = clock
        self._notify = notify
        self._write = note
        self._audit = audit
        self._departure: Departure | None = None
        self._wake = asyncio.Event()

    @contextmanager
    def page(self, identity: Identity) -> Iterator[ControlClient]:
        """Yield the client of a page, which ends with its socket."""
        client = self.clients.open_page(identity)
        self.announce()
        try:
            yield client
        finally:
            self._close(client, "its page was closed, or its connection is gone")
            self.announce()

    def open_program(self, identity: Identity) -> ControlClient:
        """Return the client of this identity's programs."""
        self.expire()
        client = self.clients.open_program(identity)
        self._wake.set()
        return client

    def take(self, client: ControlClient, *, over: bool = False) -> None:
        """Give control to a client; `over` takes it from another one. Raise RefusedError."""
        if client.identity.role != "operator":
            raise RefusedError(
                "Only operators can have control. An operator can make you one on the People page."
            )
        self.expire()
        holder = self._name(self.lease.holder)
        if holder is not None and self.lease.holder != client.number and not over:
            raise RefusedError(f"Control is with {holder}. Agree with them, then take it over.")
        self.lease.take(client.number)
        self.announce()

    def release(self, client: ControlClient) -> None:
        """Free control if this client has it."""
        self.lease.release(client.number)
        self.announce()

    def require(self, client: ControlClient | None) -> None:
        """Raise NotInControlError, with a sentence for a person, if this client has no control."""
        self.expire()
        holder = self._name(self.lease.holder)
        if holder is None:
            raise NotInControlError("Nobody has control. Take control first.")
        if client is None or client.number != self.lease.holder:
            raise NotInControlError(f"Control is with {holder}. Agree with them, then take it over.")

    def drive(self, client: ControlClient, command: DriveCommand) -> None:
        """Pass a stick command on, or drop and count it."""
        self.expire()
        self.driving.take(command, self.lease.epoch if client.number == self.lease.holder else None)

    def dismiss(self, device: int) -> None:
        """Close the clients of a device that is signed out or has another role. It may open new ones."""
        for client in self.clients.of(device):
            self._close(client, "it was signed out, or has another role")
        self._note_departure()
        self.announce()

    def state(self) -> ControlState:
        """Return the epoch, and the client in control."""
        self.expire()
        holder = self.lease.holder
        name = self._name(holder)
        return ControlState(
            epoch=self.lease.epoch,
            holder=None if holder is None or name is None else Holder(client=holder, name=name),
        )

    def programs_in_control(self) -> int:
        """Return 1 where a program has control, which it renews, else 0."""
        self.expire()
        holder = None if self.lease.holder is None else self.clients.get(self.lease.holder)
        return int(holder is not None and holder.until is not None)

    def expire(self) -> None:
        """Close the clients of programs that were silent for too long; record a page that did not return."""
        for client in self.clients.expired():
            self._close(client, f"it asked nothing for {PROGRAM_SECONDS:.0f} s")
        if self._departure is not None and self._departure.due <= self._clock.now():
            self._note_departure()

    def announce(self) -> None:
        """Send all pages the holder of control."""
        self._notify({"op": "control", **self.state().model_dump()})
        self._wake.set()

    async def run(self) -> None:
        """Expire clients when they are due, for ever."""
        while True:
            self.announce()
            self._wake.clear()
            due = self._next_expiry()
            with suppress(TimeoutError):
                async with asyncio.timeout(None if due is None else max(0.0, due - self._clock.now())):
                    await self._wake.wait()

    def _close(self, client: ControlClient, why: str) -> None:
        if client.number == self.lease.holder:
            self._audit(client.identity, why)
        self.lease.forget(client.number)
        self.clients.close(client.number)

    def _next_expiry(self) -> float | None:
        dues = [self.clients.next_expiry(), None if self._departure is None else self._departure.due]
        return min((due for due in dues if due is not None), default=None)

    def _note(self, change: Change, client: int | None, holder: int | None) -> None:
        names = {"client": f"“{self._name(client)}”", "holder": f"“{self._name(holder)}”"}
        text = TEXTS[change].format(**names)
        departed, self._departure = self._departure, None
        page = self._page(client if holder is None else holder)
        if change == "left" and page is not None:
            self._departure = Departure(page.identity.device, text, self._clock.now() + RELOAD_SECONDS)
        elif departed is None:
            self._write(text)
        elif page is None or page.identity.device != departed.device:
            self._write(departed.text)
            self._write(text)

    def _note_departure(self) -> None:
        if self._departure is not None:
            self._write(self._departure.text)
            self._departure = None

    def _page(self, number: int | None) -> ControlClient | None:
        client = None if number is None else self.clients.get(number)
        return client if client is not None and client.until is None else None

    def _name(self, number: int | None) -> str | None:
        client = None if number is None else self.clients.get(number)
        return None if client is None else client.identity.name
