"""The clients of a door: their subscriptions, their queues, and the sending.

Samples wait in a short queue for each subscription, whose oldest are dropped; answers and lines of text are
never skipped, and a client with too many of them unread is disconnected, as one that reads nothing.
"""

import asyncio
from collections import deque
from collections.abc import Callable
from contextlib import suppress

from robot_runtime.clock import Clock
from server.features.doors.channels import ChannelMessage, DoorChannel
from server.http.sign_in.identity import Identity
from server.stream.budget import DeviceBudget
from server.stream.hub import STALL_SECONDS, EvictedError, Send

QUEUE_DEFAULT, QUEUE_MAX = 50, 500
"""Samples of one subscription that wait at most."""
LINES_MAX = 1000
PICTURES_MAX = 4
"""Pictures of one subscription that wait at most, whatever the program asks for: each is up to a megabyte."""
ANSWERS_MAX, ANSWERS_BYTES_MAX = 256, 1_000_000
"""Answers that may wait unread, and their size."""
SUBSCRIPTIONS_MAX = 200

Format = Callable[[ChannelMessage], list[bytes | str]]
"""Makes the WebSocket messages of a channel's message."""


class DoorSubscription:
    """One client's subscription to a channel; `period` in s is the shortest time between two messages."""

    def __init__(self, channel: DoorChannel, form: Format) -> None:
        self.channel = channel
        self.form = form
        self.period = 0.0
        self.due = 0.0
        self.queue: deque[ChannelMessage] = deque()
        self.length = QUEUE_DEFAULT

    def offer(self, message: ChannelMessage) -> bool:
        """Queue a message; return False where the channel is lossless and too much waits."""
        self.queue.append(message)
        if self.channel.lossless:
            return len(self.queue) <= LINES_MAX
        most = min(self.length, PICTURES_MAX) if self.channel.of_pictures else self.length
        while len(self.queue) > most:
            self.queue.popleft()
        return True


class DoorClient:
    """One program's connection; `number` names it in lists."""

    def __init__(
        self,
        number: int,
        identity: Identity,
        address: str,
        send: Send,
        clock: Clock,
        budget: DeviceBudget,
    ) -> None:
        self.number = number
        self.identity = identity
        self.budget = budget
        self.address = address
        self.since = clock.now()
        self.owner = 0
        """Its number as a client of the control lease."""
        self.sent = 0
        """Messages sent."""
        self.refused = 0
        """Messages and calls of a ROS 2 program that were refused."""
        self.dismissal: EvictedError | None = None
        self.subscriptions: dict[int | str, DoorSubscription] = {}
        self.published = frozenset[str]()
        """The topics that it publishes, at rosbridge."""
        self._send_raw = send
        self._clock = clock
        self._answers: deque[bytes | str] = deque()
        self._answers_size = 0
        self._wake = asyncio.Event()

    def answer(self, message: bytes | str) -> None:
        """Queue an answer. Raise EvictedError where too many wait unread."""
        if len(self._answers) >= ANSWERS_MAX or self._answers_size > ANSWERS_BYTES_MAX:
            raise EvictedError("Too many answers wait unread.")
        self._answers.append(message)
        self._answers_size += len(message)
        self._wake.set()

    def offer(self, subscription: DoorSubscription, message: ChannelMessage) -> None:
        """Queue a message of a subscription. Raise EvictedError where too much waits unread."""
        if not subscription.offer(message):
            raise EvictedError("The connection fell too far behind; the rest is in the recording, if any.")
        self._wake.set()

    async def run(self) -> None:
        """Send queued messages, for ever. Raise EvictedError where nothing is read for too long."""
        while True:
            self._wake.clear()
            pause = await self._send_waiting()
            with suppress(TimeoutError):
                async with asyncio.timeout(pause):
                    await self._wake.wait()

    async def _send_waiting(self) -> float | None:
        """Send a message of each due subscription; return the s until the next one is due, if any."""
        await self._send_answers()
        pause: float | None = None
        for subscription in [*self.subscriptions.values()]:
            if not subscription.queue:
                continue
            remaining = subscription.due - self._clock.now()
            if remaining <= 0:
                subscription.due = max(subscription.due, self._clock.now()) + subscription.period
                for message in subscription.form(subscription.queue.popleft()):
                    await self.budget.wait_to_send(len(message))
                    await self._send(message)
                await self._send_answers()
                remaining = subscription.period if subscription.queue else remaining
            if subscription.queue:
                pause = max(0.0, remaining) if pause is None else min(pause, max(0.0, remaining))
        return pause

    async def _send_answers(self) -> None:
        while self._answers:
            message = self._answers.popleft()
            self._answers_size -= len(message)
            await self._send(message)

    async def _send(self, message: bytes | str) -> None:
        try:
            async with asyncio.timeout(STALL_SECONDS):
                await self._send_raw(message)
        except TimeoutError:
            raise EvictedError(f"Nothing was read for {STALL_SECONDS:g} s.") from None
        self.sent += 1
