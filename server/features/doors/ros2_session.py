"""The session of one connected program of ROS 2: its subscriptions, messages and calls."""

import asyncio
from collections.abc import Awaitable, Callable, Iterable
from typing import Any

from server.features.doors.channels import ChannelMessage, DoorChannel
from server.features.doors.commands import REFUSALS, STOP, TAKE, DoorCommands, DoorPilot
from server.features.doors.house import ROS2, Doors
from server.features.doors.ros2_messages import PAYLOAD_MAX, TRIGGER, ros2_types
from server.features.doors.ros2_names import Endpoint
from server.features.doors.ros2_node import Incoming, Ros2Node
from server.features.doors.rosapi import command_services
from server.features.doors.session import DoorSession, UnusableMessageError
from server.features.doors.subscriptions import DoorClient, DoorSubscription
from server.features.doors.twist import STOP_TOPIC, TAKEN_IN, read_twist

LINES_DEPTH = 1000
"""As ROS's own loggers publish /rosout."""
WAITING_MAX = 64
"""Messages and calls of a program that wait for this process; STOPs may be as many besides."""
FIELDS: dict[str, dict[str, Any]] = {
    **{name.rpartition("/")[2]: {} for name, kind in command_services().items() if kind == TRIGGER},
    TAKE: {},
    "arm": {"mode": "manual"},
}
"""The commands that are services here, and their fields: a Trigger has none of its own."""


def ros2_endpoints(channels: Iterable[DoorChannel]) -> list[Endpoint]:
    """Return the topics and services of the robot's node."""
    types = ros2_types()

    def published(channel: DoorChannel) -> Endpoint:
        depth = LINES_DEPTH if channel.lossless else 1 if channel.latched else 10
        return Endpoint("MP", channel.name, channel.type, types.hash(channel.type), depth, channel.latched)

    return [
        *map(published, channels),
        *(Endpoint("MS", name, kind, types.hash(kind)) for name, kind in TAKEN_IN.items()),
        *(Endpoint("SS", f"/mucat/{name}", TRIGGER, types.hash(TRIGGER)) for name in FIELDS),
    ]


class Ros2Session(DoorSession):
    """A program's session; `doors` passes the samples on to it.

    Invalid messages are refused and counted, but disconnect no program: a router may have other nodes behind
    it.
    """

    def __init__(
        self,
        client: DoorClient,
        pilot: DoorPilot,
        doors: Doors,
        commands: DoorCommands,
        writable: Callable[[], Awaitable[None]],
    ) -> None:
        super().__init__(client)
        self._pilot = pilot
        self._doors = doors
        self._door = doors.doors[ROS2]
        self._commands = commands
        self._writable = writable
        self._waiting: asyncio.Queue[Incoming] = asyncio.Queue()
        self._loop = asyncio.get_running_loop()
        self._channels = [*self._door.publisher.channels]

    async def run(self, node: Ros2Node) -> None:
        """Act on received messages and calls, for ever."""
        try:
            while True:
                self.act(await self._waiting.get(), node)
                await self.pause()
        finally:
            calls = self.cancel_calls()
            await asyncio.gather(*calls, return_exceptions=True)

    def act(self, incoming: Incoming, node: Ros2Node) -> None:
        """Act on a message or a call, or refuse it."""
        try:
            self._act(incoming, node)
        except UnusableMessageError as problem:
            self.client.refused += 1
            self._commands.note_refusal(self._pilot, f"ROS 2 {incoming.endpoint.name}", str(problem))
        except REFUSALS:  # the commands have written it into the audit log
            self.client.refused += 1

    def receive(self, incoming: Incoming) -> None:
        """Queue a message, from any thread."""
        self._loop.call_soon_threadsafe(self._queue, incoming)

    def match(self, endpoint: Endpoint, subscribed: bool) -> None:
        """Store a topic's state of subscription, from any thread."""
        self._loop.call_soon_threadsafe(self._note_match, endpoint.name, subscribed)

    def unpack(self, data: bytes) -> tuple[str, bytes]:
        """Return the topic and the CDR of a message queued for the program."""
        return self._channels[int.from_bytes(data[:2], "little")], data[2:]

    def _queue(self, incoming: Incoming) -> None:
        stop = incoming.endpoint.name == STOP_TOPIC
        # Where a STOP finds no place, others wait that begin after it.
        if self._waiting.qsize() >= (2 * WAITING_MAX if stop else WAITING_MAX):
            self.client.refused += 1
            return
        self._waiting.put_nowait(incoming)

    def _note_match(self, name: str, subscribed: bool) -> None:
        if self.client not in self._door.clients:
            return  # it is being disconnected, and nobody would end a subscription any more
        subscription = self.client.subscriptions.pop(name, None)
        if subscription is not None:
            self._door.publisher.unsubscribe(subscription)
        if subscribed:
            number = self._channels.index(name).to_bytes(2, "little")

            def form(message: ChannelMessage) -> list[bytes | str]:
                return [number + message.cdr]

            subscription = DoorSubscription(self._door.publisher.channels[name], form)
            self.client.subscriptions[name] = subscription
            self._door.publisher.greet(self.client, subscription, self._doors.newest())
            self._door.publisher.subscribe(self.client, subscription)
        self._doors.count_audience()

    def _act(self, incoming: Incoming, node: Ros2Node) -> None:
        endpoint = incoming.endpoint
        if endpoint.name == STOP_TOPIC:  # whatever the message is
            # Without its attachment a call cannot be answered; STOP is carried out nevertheless.
            stop = self._stop() if incoming.query is None else self._answer(incoming, STOP, node)
            self.begin(stop, always=True)
            return
        if not incoming.typed:
            raise UnusableMessageError(
                f"{endpoint.name} has the type {endpoint.type}, with ROS 2's own hash."
            )
        if incoming.payload is None:
            raise UnusableMessageError(f"A message may have {PAYLOAD_MAX} bytes.")
        if incoming.query is not None:
            self._call(incoming, incoming.payload, node)
        else:
            linear, angular = read_twist(_decode(endpoint.type, incoming.payload))
            self._commands.drive(self._pilot, linear, angular)

    async def _stop(self) -> None:
        await self._perform(STOP)

    def _call(self, incoming: Incoming, payload: bytes, node: Ros2Node) -> None:
        _decode(f"{TRIGGER}_Request", payload)
        self.begin(self._answer(incoming, incoming.endpoint.name.rpartition("/")[2], node))

    async def _answer(self, incoming: Incoming, name: str, node: Ros2Node) -> None:
        success, message = await self._perform(name)
        payload = ros2_types().encode(f"{TRIGGER}_Response", {"success": success, "message": message})
        try:
            await self._writable()
            # Zenoh waits where the program reads nothing.
            await asyncio.to_thread(node.answer, incoming, payload)
        except OSError:
            return  # the program has left
        except UnusableMessageError as problem:
            self.client.refused += 1
            self._commands.note_refusal(self._pilot, f"ROS 2 {incoming.endpoint.name}", str(problem))

    async def _perform(self, name: str) -> tuple[bool, str]:
        try:
            return True, await self._commands.perform(self._pilot, name, FIELDS[name])
        except REFUSALS as problem:
            self.client.refused += 1
            return False, str(problem)


def _decode(kind: str, payload: bytes) -> dict[str, Any]:
    try:
        return ros2_types().decode(kind, payload)
    except ValueError as problem:
        raise UnusableMessageError(str(problem)) from problem
