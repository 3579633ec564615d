"""The doors of a server: the open ones, their clients, and the samples for them."""

import asyncio
import secrets
from collections.abc import Awaitable, Callable, Iterable, Mapping
from time import time as utc_time
from typing import Any, Literal

from robot_runtime.clock import Clock
from robot_runtime.contract.topics import BY_NAME, PARAMETERS
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

    def evict(self, client: DoorClient, reason: EvictedError) -> None:
        """Disconnect a client with a reason."""
        if client in self.clients and client.dismissal is None:
            client.dismissal = reason
            self.clients[client].cancel()


class Doors:
    """All doors; `see` takes every block that the server delivers."""

    def __init__(self, settings: Settings, clock: Clock, hub: Hub, budgets: Budgets) -> None:
        simulated = settings.robot.mode != "robot"
        config = settings.section(DoorsConfig)
        self.doors: dict[str, Door] = {
            "rosbridge": Door("rosbridge", config.rosbridge, ros_channels()),
            "foxglove": Door("foxglove", config.foxglove, foxglove_channels(simulated)),
            ROS2: Door(ROS2, config.ros2, standard_channels(), config.ros2_listen),
        }
        self.robot = settings.robot.name
        self.session = secrets.token_hex(8)
        """Names this run of the server: a program that connects again sees whether it is another."""
        self._clock = clock
        self._hub = hub
        self._budgets = budgets
        self._newest: dict[str, Sample] = {}
        self._set: dict[str, tuple[float, Any]] = {}
        """Values of parameters that were set, and when the runtime answered so: its document comes later."""
        self._number = 0

    def see(self, block: Block) -> None:
        """Pass a block on to the clients of all doors."""
        topic = block.topic
        listening = [door for door in self.doors.values() if door.publisher.listens(topic.name)]
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
        """Pass on the health of the robot's parts."""
        sample = Sample(HEALTH, self.utc_ns(), {"parts": parts})
        self._newest[HEALTH] = sample
        self._publish(HEALTH, [sample], self.doors.values())

    def newest(self) -> list[Sample]:
        """Return the newest document of each topic whose newest document states everything.

        While the runtime has failed, its documents are left out: they no longer state the present.
        """
        health = self._newest.get(HEALTH)
        parts = health.value["parts"] if health is not None and isinstance(health.value, Mapping) else []
        silent = any(part["name"] == "runtime" and part["state"] == "failed" for part in parts)
        return [
            sample
            for name, sample in self._newest.items()
            if not (silent and name in BY_NAME and BY_NAME[name].sender == "runtime")
        ]

    def document(self, name: str) -> Mapping[str, Any]:
        """Return the newest document of such a topic; an empty document before the first."""
        sample = self._newest.get(name)
        return sample.value if sample is not None and isinstance(sample.value, Mapping) else {}

    def note_parameters(self, values: Mapping[str, Any]) -> None:
        """Store values that the runtime has confirmed."""
        now = self._clock.now()
        self._set |= {name: (now, value) for name, value in values.items()}

    def parameters(self) -> dict[str, Mapping[str, Any]]:
        """Return all parameters by name, as documents describe them, with their values in force."""
        document = self.document(PARAMETERS.name)
        parameters = {str(parameter["name"]): parameter for parameter in document.get("parameters", [])}
        for name, (moment, value) in self._set.items():
            if name in parameters and document["time"] < moment:
                parameters[name] = {**parameters[name], "value": value}
        return parameters

    def utc_ns(self) -> int:
        """Return the present time, in ns since 1970."""
        return round(utc_time() * BILLION)

    def count_audience(self) -> None:
        """Have the subscribed pictures encoded, after a change of subscriptions."""
        sources = frozenset[str]().union(*(door.publisher.sources() for door in self.doors.values()))
        self._hub.require_pictures(sources)

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
        """Serve a program until `receive` returns. Raise EvictedError where it is disconnected."""
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
        own = sum(client.identity.device == identity.device for client in door.clients)
        if identity != SHELL and own >= DEVICE_MAX:
            raise EvictedError(f"This token has {DEVICE_MAX} connections open already; close one.")
        limit = CLIENTS_MAX if identity.role == "operator" else CLIENTS_MAX - OPERATORS_ONLY
        if len(door.clients) >= limit:
            raise EvictedError(f"{limit} programs are connected already; close one.")

    def _publish(self, source: str, samples: list[Sample], doors: Iterable[Door]) -> None:
        for door in doors:
            door.publisher.publish(source, samples)
