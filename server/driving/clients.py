"""The clients of the control lease: pages and programs. A browser may have several pages open."""

import secrets
from dataclasses import dataclass

from robot_runtime.clock import Clock
from server.http.sign_in.identity import Identity

PROGRAM_SECONDS = 10.0
"""A program's client expires this long after its last request that needs control."""


@dataclass(slots=True)
class ControlClient:
    """One page, or the programs of one token. `key` is a page's secret, "" for programs; `until` is when a
    program's client ends (s), None for a page.
    """

    number: int
    identity: Identity
    key: str
    until: float | None


class ControlClients:
    """The open clients, by number; no number is used twice."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._clients: dict[int, ControlClient] = {}
        self._last = 0

    def open_page(self, identity: Identity) -> ControlClient:
        """Return a client for a page, until it is closed."""
        return self._open(identity, secrets.token_urlsafe(24), None)

    def open_program(self, identity: Identity) -> ControlClient:
        """Return the client of this identity's programs, opened where there is none."""
        client = self.find(identity, None)
        return client or self._open(identity, "", self._clock.now() + PROGRAM_SECONDS)

    def find(self, identity: Identity, key: str | None) -> ControlClient | None:
        """Return the page with this key; without a key the identity's programs, whose time starts anew."""
        if key is None:
            now = self._clock.now()
            for client in self.of(identity.device):
                if client.until is not None and client.until > now:
                    client.until = now + PROGRAM_SECONDS
                    return client
            return None
        newest = None
        for client in self.of(identity.device):
            # Every key is compared, so that the time taken reveals nothing.
            if client.key and secrets.compare_digest(client.key.encode(), key.encode()):
                newest = client
        return newest

    def get(self, number: int) -> ControlClient | None:
        """Return the client of this number."""
        return self._clients.get(number)

    def of(self, device: int) -> list[ControlClient]:
        """Return the clients of one device."""
        return [client for client in self._clients.values() if client.identity.device == device]

    def close(self, number: int) -> None:
        """Remove a client, if it is there."""
        self._clients.pop(number, None)

    def expired(self) -> list[ControlClient]:
        """Return the clients of programs that have been silent for too long."""
        now = self._clock.now()
        return [client for client in self._programs() if client.until is not None and client.until <= now]

    def next_expiry(self) -> float | None:
        """Return the time (s) at which the next client expires unless it is used before."""
        return min((client.until for client in self._programs() if client.until is not None), default=None)

    def _programs(self) -> list[ControlClient]:
        return [client for client in self._clients.values() if client.until is not None]

    def _open(self, identity: Identity, key: str, until: float | None) -> ControlClient:
        self._last += 1
        client = ControlClient(self._last, identity, key, until)
        self._clients[client.number] = client
        return client
