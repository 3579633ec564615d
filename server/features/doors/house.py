"""The doors of a server: which are open, who is connected, and the samples on their way to them."""

import asyncio
import secrets
from collections.abc import Awaitable, Callable, Iterable, Mapping
from contextlib import suppress
from time import time as utc_time
from typing import Any, Literal

from robot_runtime.clock import Clock
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block
from server.features.doors.channels import HEALTH, DoorChannel, Sample, read_samples
from server.features.doors.config import DoorsConfig
from server.features.doors.foxglove_channels import foxglove_channels
from server.features.doors.publisher import Publisher
from server.features.doors.ros_channels import BILLION, ros_channels, standard_channels
from server.features.doors.subscriptions import DoorClient
from server.http.security import POLICY_VIOLATION
from server.http.sign_in.identity import SHELL, Identity
from server.platform.settings import Settings
from server.stream.budget import Budgets
from server.stream.hub import DEVICE_MAX, EvictedError, Hub, Send

DoorName = Literal["rosbridge", "foxglove", "ros2"]
ROS2: DoorName = "ros2"
CLIENTS_MAX, OPERATORS_ONLY = 20, 5
"""Programs at one door; of these, so many are for operators alone."""
CHANGE_SECONDS = 0.1
"""From a change of topics or clients to telling it."""


class Door:
    """One door: its publisher and its clients."""

    def __init__(self, name: DoorName, open_: bool, channels: Iterable[DoorChannel], path: str = "") -> None:
        self.name = name
        self.path = path or f"/{name}"
        """Its path below the server's address, or an endpoint of Zenoh."""
        self.open = open_
        self.publisher = Publisher(channels, self.evict)
        self.clients: dict[DoorClient, asyncio.Task[None]] = {}
        self.strangers = 0
        """Connections that have shown no token yet."""
        self.published: dict[DoorClient, frozenset[str]] = {}
        """The topics that its clients publish."""

    def evict(self, client: DoorClient, reason: EvictedError) -> None:
        """Disconnect a client with a reason."""
        if client in self.clients and client.dismissal is None:
            client.dismissal = reason
            self.clients[client].cancel()


class Doors:
    """All doors; `see` takes every block that the server delivers."""

    def __init__(self, settings: Settings, clock: Clock, hub: Hub, budgets: Budgets) -> None:
        simulated = settings.mode != "robot"
        config = settings.section(DoorsConfig)
        self.doors: dict[str, Door] = {
            "rosbridge": Door("rosbridge", config.rosbridge, ros_channels()),
            "foxglove": Door("foxglove", config.foxglove, foxglove_channels(simulated)),
            ROS2: Door(ROS2, config.ros2, standard_channels(), config.ros2_listen),
        }
        self.robot = settings.robot
        self.session = secrets.token_hex(8)
        """Names this run of the server: a program that connects again sees whether it is another."""
        self.changed: list[Callable[[], None]] = []
        """Called when topics or clients of a door change."""
        self._clock = clock
        self._hub = hub
        self._budgets = budgets
        self._open = any(door.open for door in self.doors.values())
        self._newest: dict[str, Sample] = {}
        self._telling: asyncio.TimerHandle | None = None
        self._set: dict[str, tuple[float, Any]] = {}
        """Values of parameters that were set, and when the runtime answered so: its document comes later."""
        self._number = 0

    def see(self, block: Block) -> None:
        """Pass a block on to the clients of all doors."""
        if not self._open:
            return
        topic = block.topic
        listening = [one for one in self.doors.values() if one.publisher.listens(topic.name)]
        if not (listening or topic.newest_only):
            return
        offset = utc_time() - self._clock.now()
        try:
            samples = [
                Sample(topic.name, round((time + offset) * BILLION), value)
                for time, value in read_samples(block)
            ]
        except ValueError:
            return  # the recorder has reported it
        if topic.newest_only and samples:
            self._newest[topic.name] = samples[-1]
        self._publish(topic.name, samples, listening)

    def see_health(self, parts: list[dict[str, Any]]) -> None:
        """Pass the health of the robot's parts on."""
        if self._open:
            sample = Sample(HEALTH, self.utc_ns(), {"parts": parts})
            self._newest[HEALTH] = sample
            self._publish(HEALTH, [sample], self.doors.values())

    def newest(self) -> list[Sample]:
        """The newest document of each topic of which the newest says everything.

        While the runtime has failed, none of its own: nobody is sent for the present what was its last word.
        """
        health = self._newest.get(HEALTH)
        parts = health.value["parts"] if health is not None and isinstance(health.value, Mapping) else []
        silent = any(one["name"] == "runtime" and one["state"] == "failed" for one in parts)
        return [
            one
            for name, one in self._newest.items()
            if not (silent and name in BY_NAME and BY_NAME[name].sender == "runtime")
        ]

    def document(self, name: str) -> Mapping[str, Any]:
        """The newest document of such a topic; an empty one before the first."""
        found = self._newest.get(name)
        return found.value if found is not None and isinstance(found.value, Mapping) else {}

    def note_parameters(self, values: Mapping[str, Any]) -> None:
        """Note values of which the runtime has answered that they are in force."""
        now = self._clock.now()
        self._set |= {name: (now, value) for name, value in values.items()}

    def parameters(self) -> dict[str, Mapping[str, Any]]:
        """All parameters by name, as documents describe them, with their values in force."""
        document = self.document("parameters")
        found = {str(one["name"]): one for one in document.get("parameters", [])}
        for name, (moment, value) in self._set.items():
            if name in found and document["time"] < moment:
                found[name] = {**found[name], "value": value}
        return found

    def utc_ns(self) -> int:
        """The time now, in ns since 1970."""
        return round(utc_time() * BILLION)

    def count_audience(self) -> None:
        """Have those pictures encoded that somebody subscribes to, after a change of subscriptions."""
        sources = frozenset[str]().union(*(door.publisher.sources() for door in self.doors.values()))
        self._hub.require_pictures(sources)
        self.note_change()

    def note_change(self) -> None:
        """Tell those who watch the connections between programs and topics, soon: many changes are one."""
        if self.changed and self._telling is None:
            self._telling = asyncio.get_running_loop().call_later(CHANGE_SECONDS, self._tell)

    def _tell(self) -> None:
        self._telling = None
        for changed in [*self.changed]:
            # A program that reads too little of it is disconnected by its own messages.
            with suppress(EvictedError):
                changed()

    def dismiss(self, device: int, reason: str) -> None:
        """End all connections of this device, with a reason."""
        for door in self.doors.values():
            for client in [*door.clients]:
                if client.identity.device == device:
                    door.evict(client, EvictedError(reason, POLICY_VIOLATION))

    async def serve(
        self,
        door: Door,
        send: Send,
        identity: Identity,
        address: str,
        receive: Callable[[DoorClient], Awaitable[None]],
    ) -> None:
        """Serve a program until `receive` returns. Raises EvictedError where it is disconnected."""
        self._check_room(door, identity)
        self._number += 1
        budget = self._budgets.of(identity)
        client = DoorClient(self._number, identity, address, send, self._clock, budget)
        sender = asyncio.create_task(client.run())
        receiver = asyncio.ensure_future(receive(client))
        door.clients[client] = sender
        try:
            await asyncio.wait({sender, receiver}, return_when=asyncio.FIRST_COMPLETED)
        finally:
            del door.clients[client]
            door.published.pop(client, None)
            for subscription in client.subscriptions.values():
                door.publisher.unsubscribe(subscription)
            self.count_audience()
            sender.cancel()
            receiver.cancel()
            outcomes = await asyncio.gather(sender, receiver, return_exceptions=True)
        if client.dismissal is not None:
            raise client.dismissal
        for outcome in outcomes:
            if isinstance(outcome, Exception):
                raise outcome

    def _check_room(self, door: Door, identity: Identity) -> None:
        own = sum(one.identity.device == identity.device for one in door.clients)
        if identity != SHELL and own >= DEVICE_MAX:
            raise EvictedError(f"This token has {DEVICE_MAX} connections open already; close one.")
        limit = CLIENTS_MAX if identity.role == "operator" else CLIENTS_MAX - OPERATORS_ONLY
        if len(door.clients) >= limit:
            raise EvictedError(f"{limit} programs are connected already; close one.")

    def _publish(self, source: str, samples: list[Sample], doors: Iterable[Door]) -> None:
        for door in doors:
            door.publisher.publish(source, samples)
