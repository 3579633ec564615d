"""rosbridge v2 for one program: operations in JSON, answered in JSON or CBOR as it asks."""

import json
from collections.abc import Awaitable, Callable
from typing import Any

from server.features.doors.channels import encode_json
from server.features.doors.commands import REFUSALS, STOP, DoorCommands, DoorPilot
from server.features.doors.house import Door, Doors
from server.features.doors.ros_channels import type_name
from server.features.doors.rosapi import RosApi, name_of
from server.features.doors.session import (
    DoorSession,
    UnusableMessageError,
    mapping_of,
    number_of,
    read_json,
    text_of,
)
from server.features.doors.subscriptions import (
    QUEUE_DEFAULT,
    QUEUE_MAX,
    SUBSCRIPTIONS_MAX,
    DoorClient,
    DoorSubscription,
)
from server.features.doors.twist import CMD_VEL, STOP_TOPIC, TAKEN_IN, read_twist

LEVELS = ("info", "warning", "error", "none")
COMPRESSIONS = ("none", "png", "cbor")
"""The compressions that a program may name; `png` is accepted and sends none."""
THROTTLE_MAX = 3_600_000
"""ms."""
REFUSED_OPS = {
    "fragment": "Fragments are not put together here: send messages of up to 4 KiB whole.",
    "png": "Pictures are not unpacked here: send operations as JSON.",
    "advertise_service": "Programs cannot offer services to the robot.",
    "unadvertise_service": "Programs cannot offer services to the robot.",
    "service_response": "Programs cannot offer services to the robot.",
    "advertise_action": "There are no actions here; commands are services.",
    "unadvertise_action": "There are no actions here; commands are services.",
    "send_action_goal": "There are no actions here; commands are services.",
    "cancel_action_goal": "There are no actions here; commands are services.",
    "action_feedback": "There are no actions here; commands are services.",
    "action_result": "There are no actions here; commands are services.",
    "auth": "This connection is signed in already.",
}
"""Operations of the protocol that are answered with this reason."""


class RosbridgeSession(DoorSession):
    """A program's session of operations; `doors` passes the samples on to it."""

    def __init__(
        self, client: DoorClient, pilot: DoorPilot, doors: Doors, door: Door, commands: DoorCommands
    ) -> None:
        super().__init__(client)
        self._pilot = pilot
        self._doors = doors
        self._door = door
        self._commands = commands
        self._api = RosApi(doors, door, commands, pilot)
        self._level = "error"
        self._asked: dict[str, dict[str, dict[str, Any]]] = {}
        """What is asked of each topic, by the subscription's id: several of one program share a stream."""
        self._advertised: dict[str, str] = {}
        self._operations: dict[str, Callable[[dict[str, Any]], None]] = {
            "subscribe": self._subscribe,
            "unsubscribe": self._unsubscribe,
            "advertise": self._advertise,
            "unadvertise": self._unadvertise,
            "publish": self._publish,
            "call_service": self._call_service,
            "set_level": self._set_level,
            "status": lambda _: None,
        }

    async def run(self, receive: Callable[[], Awaitable[str | bytes | None]]) -> None:
        """Act on operations until the program leaves. Raise EvictedError."""
        await self.listen(receive, self.act, lambda text: self._say("error", text))

    def act(self, text: str | bytes) -> None:
        """Act on an operation. Raise UnusableMessageError."""
        message = read_operation(text)
        name = message.get("op")
        operation = self._operations.get(name) if isinstance(name, str) else None
        if operation is None:
            known = REFUSED_OPS.get(name) if isinstance(name, str) else None
            raise UnusableMessageError(known or f"Unknown op {json.dumps(name)[:80]}.")
        operation(message)

    def _subscribe(self, message: dict[str, Any]) -> None:
        name = name_of(message, "topic")
        channel = self._door.publisher.channels.get(name)
        if channel is None:
            raise UnusableMessageError(f"There is no topic {name}; /rosapi/topics lists them.")
        _check_type(message.get("type"), name, channel.type)
        asked = {
            "period": number_of(message.get("throttle_rate", 0), "throttle_rate", THROTTLE_MAX) / 1000,
            "length": int(number_of(message.get("queue_length", 0), "queue_length", float(2**53))),
            "compression": message.get("compression", "none"),
        }
        if asked["compression"] not in COMPRESSIONS:
            raise UnusableMessageError(
                f"There is no compression {json.dumps(asked['compression'])[:80]} here, but "
                f"{', '.join(COMPRESSIONS)}."
            )
        subscription = self.client.subscriptions.get(name)
        by_id = self._asked.setdefault(name, {})
        count = sum(map(len, self._asked.values()))
        if count >= SUBSCRIPTIONS_MAX:
            raise UnusableMessageError(f"A program may have {SUBSCRIPTIONS_MAX} subscriptions.")
        by_id[_identifier(message)] = asked
        if subscription is None:
            subscription = DoorSubscription(channel, lambda _: [])
            self.client.subscriptions[name] = subscription
            self._settle(subscription)
            self._door.publisher.greet(self.client, subscription, self._doors.newest())
            self._door.publisher.subscribe(self.client, subscription)
            self._doors.count_audience()
        else:
            self._settle(subscription)

    def _settle(self, subscription: DoorSubscription) -> None:
        """Merge all requests of a topic into one stream: the fastest and longest."""
        asked = self._asked[subscription.channel.name].values()
        subscription.period = min(request["period"] for request in asked)
        lengths = [request["length"] for request in asked]
        least = 1 if subscription.period else QUEUE_DEFAULT
        subscription.length = min(QUEUE_MAX, max(lengths)) or least
        # CBOR only where each of them asked for it: the others could not read it.
        in_cbor = all(request["compression"] == "cbor" for request in asked)
        subscription.form = (
            (lambda message: [message.cbor]) if in_cbor else (lambda message: [message.publication])
        )

    def _unsubscribe(self, message: dict[str, Any]) -> None:
        name = name_of(message, "topic")
        asked = self._asked.get(name, {})
        if "id" in message:
            asked.pop(_identifier(message), None)
        else:
            asked.clear()
        subscription = self.client.subscriptions.get(name)
        if subscription is None:
            return
        if asked:
            self._settle(subscription)
            return
        self._asked.pop(name, None)
        del self.client.subscriptions[name]
        self._door.publisher.unsubscribe(subscription)
        self._doors.count_audience()

    def _advertise(self, message: dict[str, Any]) -> None:
        name = name_of(message, "topic")
        if name not in TAKEN_IN:
            raise UnusableMessageError(f"Programs may publish {', '.join(TAKEN_IN)}, and not {name}.")
        _check_type(message.get("type"), name, TAKEN_IN[name])
        self._advertised[name] = TAKEN_IN[name]
        self.client.published = frozenset(self._advertised)

    def _unadvertise(self, message: dict[str, Any]) -> None:
        self._advertised.pop(name_of(message, "topic"), None)
        self.client.published = frozenset(self._advertised)

    def _publish(self, message: dict[str, Any]) -> None:
        name = name_of(message, "topic")
        if name == STOP_TOPIC:
            self.begin(self._stop(), always=True)
        elif name == CMD_VEL:
            linear, angular = read_twist(message.get("msg"))
            try:
                self._commands.drive(self._pilot, linear, angular)
            except REFUSALS as problem:
                self._say("error", f"{CMD_VEL}: {problem}", message.get("id"))
        else:
            raise UnusableMessageError(f"Programs may publish {', '.join(TAKEN_IN)}, and not {name}.")

    async def _stop(self) -> None:
        try:
            await self._commands.perform(self._pilot, STOP, {})
        except REFUSALS as problem:
            self._say("error", f"STOP has not been confirmed: {problem}")

    def _call_service(self, message: dict[str, Any]) -> None:
        name = name_of(message, "service")
        given = message.get("id")
        identifier = given if isinstance(given, str | int) else None
        if name == STOP_TOPIC:
            self.begin(self._answer_call(name, {}, identifier), always=True)  # whatever the message is
            return
        try:
            _identifier(message)
            arguments = self._api.arguments(name, message.get("args", {}))
            self.begin(self._answer_call(name, arguments, identifier))
        except UnusableMessageError as problem:
            self._respond(name, identifier, str(problem), False)

    async def _answer_call(self, name: str, arguments: dict[str, Any], identifier: object) -> None:
        try:
            values = await self._api.call(name, arguments)
        except (UnusableMessageError, *REFUSALS) as problem:
            self._respond(name, identifier, str(problem), False)
        else:
            self._respond(name, identifier, values, True)

    def _respond(self, name: str, identifier: object, values: object, result: bool) -> None:
        answer = {"op": "service_response", "service": name, "values": values, "result": result}
        if identifier is not None:
            answer["id"] = identifier
        self.client.answer(encode_json(answer))

    def _set_level(self, message: dict[str, Any]) -> None:
        if message.get("level") not in LEVELS:
            raise UnusableMessageError(f"level must be one of {', '.join(LEVELS)}.")
        self._level = message["level"]

    def _say(self, level: str, text: str, identifier: object = None) -> None:
        if LEVELS.index(level) < LEVELS.index(self._level):
            return
        status = {"op": "status", "level": level, "msg": text}
        if isinstance(identifier, str | int):
            status["id"] = str(identifier)
        self.client.answer(encode_json(status))


def read_operation(text: str | bytes) -> dict[str, Any]:
    """Return an operation of rosbridge. Raise UnusableMessageError."""
    if isinstance(text, bytes):
        raise UnusableMessageError("Operations must be text: JSON.")
    return mapping_of(read_json(text, "An operation"), "An operation")


def _check_type(given: object, name: str, expected: str) -> None:
    if given is None or given in ("", "*"):
        return
    if type_name(text_of(given, "type")) != expected:
        raise UnusableMessageError(f"{name} has the type {expected}, and not {given}.")


def _identifier(message: dict[str, Any]) -> str:
    value = message.get("id", "")
    if isinstance(value, bool) or not isinstance(value, str | int) or len(str(value)) > 200:
        raise UnusableMessageError("id must be a text of up to 200 characters.")
    return str(value)
