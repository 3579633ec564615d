"""The budget of a viewer: messages to and from the sockets of one device.

A device has many sockets, and each message costs the event loop some time, which heartbeats and STOP need.
Whoever asks for more waits; nothing is lost but what a slow client loses as well. Operators share none:
what one of their programs sends must not make the commands of another late.
"""

import asyncio

from robot_runtime.clock import Clock
from server.http.sign_in.identity import Identity

RECEIVED_PER_SECOND, RECEIVED_BURST = 100.0, 500.0
SENT_PER_SECOND, SENT_BURST = 2000.0, 4000.0
"""Messages; a large one counts as one for each `SENT_BYTES`. Every topic at the robot's full rate is less."""
SENT_BYTES = 2048
STREAM_PER_SECOND, STREAM_BURST = 65_536.0, 524_288.0
"""Bytes of programs whose messages cannot be counted: a router of ROS 2 first tells of all its nodes."""


class Allowance:
    """An amount that refills at `rate` per s, up to `most`."""

    def __init__(self, clock: Clock, rate: float, most: float) -> None:
        self._clock = clock
        self._rate = rate
        self._most = self._balance = most
        self._last = clock.now()

    def spend(self, amount: float) -> float:
        """Spend this amount; return the time (s) to wait until it has refilled, 0 where it was available."""
        now = self._clock.now()
        self._balance = min(self._most, self._balance + (now - self._last) * self._rate) - amount
        self._last = now
        return max(0.0, -self._balance / self._rate)


class DeviceBudget:
    """The budget of one device."""

    def __init__(self, clock: Clock, *, limited: bool) -> None:
        self._clock = clock
        self._limited = limited
        self._received = Allowance(clock, RECEIVED_PER_SECOND, RECEIVED_BURST)
        self._sent = Allowance(clock, SENT_PER_SECOND, SENT_BURST)
        self._streamed = self._make_streamed()

    async def wait_to_receive(self) -> None:
        """Wait after a message of the client until the next one may be read."""
        if self._limited and (wait := self._received.spend(1.0)) > 0:
            await asyncio.sleep(wait)

    async def wait_to_send(self, size: int) -> None:
        """Wait until a message of so many bytes may be sent."""
        if self._limited and (wait := self._sent.spend(1.0 + size // SENT_BYTES)) > 0:
            await asyncio.sleep(wait)

    def open_stream(self) -> Allowance:
        """Return the allowance of a new connection: a viewer's connections share it, an operator's not."""
        return self._streamed if self._limited else self._make_streamed()

    def _make_streamed(self) -> Allowance:
        return Allowance(self._clock, STREAM_PER_SECOND, STREAM_BURST)


class Budgets:
    """The budgets of all devices."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._of: dict[tuple[int, bool], DeviceBudget] = {}

    def of(self, caller: Identity) -> DeviceBudget:
        """Return the budget of a caller's device."""
        limited = caller.role != "operator"
        key = caller.device, limited
        if key not in self._of:
            self._of[key] = DeviceBudget(self._clock, limited=limited)
        return self._of[key]
