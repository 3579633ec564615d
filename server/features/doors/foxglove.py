"""The Foxglove WebSocket protocol (foxglove/ws-protocol, version 1) for one program."""

import json
from collections.abc import Awaitable, Callable, Mapping
from struct import Struct, error
from typing import Any

from server.features.doors.channels import ChannelMessage, DoorChannel, encode_json
from server.features.doors.commands import REFUSALS, STOP, DoorCommands, DoorPilot
from server.features.doors.foxglove_channels import CHANGED, CLOCK, schema_text
from server.features.doors.foxglove_services import SERVICES, advertise_services
from server.features.doors.house import Door, Doors
from server.features.doors.ros_channels import type_name
from server.features.doors.session import (
    NAME_MAX,
    DoorSession,
    UnusableMessageError,
    mapping_of,
    read_json,
    text_of,
)
from server.features.doors.subscriptions import SUBSCRIPTIONS_MAX, DoorClient, DoorSubscription
from server.features.doors.twist import CMD_VEL, STOP_TOPIC, TAKEN_IN, read_twist

SUBPROTOCOLS = ("foxglove.sdk.v1", "foxglove.websocket.v1")
CAPABILITIES = (
    "clientPublish",
    "parameters",
    "parametersSubscribe",
    "services",
    "time",
)
MESSAGE, TIME, SERVICE_ANSWER = range(1, 4)
PUBLISHED, SERVICE_CALL = 1, 2
ERROR = 2
"""The status level."""
NUMBER_MAX = 2**32 - 1
_MESSAGE = Struct("<BIQ")
_TIME = Struct("<BQ")
_PUBLISHED = Struct("<BI")
_SERVICE = Struct("<BIII")


class FoxgloveSession(DoorSession):
    """A program's session; `doors` passes the samples on to it."""

    def __init__(
        self, client: DoorClient, pilot: DoorPilot, doors: Doors, door: Door, commands: DoorCommands
    ) -> None:
        super().__init__(client)
        self._pilot = pilot
        self._doors = doors
        self._door = door
        self._commands = commands
        channels = [channel for channel in door.publisher.channels.values() if not channel.hidden]
        self._channels: dict[int, DoorChannel] = dict(enumerate(channels, 1))
        self._published: dict[int, str] = {}
        """The topics that the program publishes, by its own numbers."""
        self._unusable: dict[int, str] = {}
        """The others that it has advertised: Foxglove does so for three as soon as it shows a 3D panel."""
        self._watched: set[str] = set()
        """The parameters whose changes it wants to know."""
        self._known: dict[str, Any] = {}
        self._operations: dict[str, Callable[[dict[str, Any]], None]] = {
            "subscribe": self._subscribe,
            "unsubscribe": self._unsubscribe,
            "advertise": self._advertise,
            "unadvertise": self._unadvertise,
            "getParameters": self._get_parameters,
            "setParameters": self._set_parameters,
            "subscribeParameterUpdates": self._watch_parameters,
            "unsubscribeParameterUpdates": self._forget_parameters,
        }

    async def run(self, receive: Callable[[], Awaitable[str | bytes | None]]) -> None:
        """Greet the program, and act on its messages until it leaves. Raise EvictedError."""
        self._greet()
        await self.listen(receive, self.act, lambda text: self._say(ERROR, text))

    def _greet(self) -> None:
        self._answer(
            op="serverInfo",
            name=f"µ-CAT {self._doors.robot}",
            capabilities=CAPABILITIES,
            supportedEncodings=["json"],
            metadata={"robot": self._doors.robot},
            sessionId=self._doors.session,
        )
        self._answer(
            op="advertise",
            channels=[
                {
                    "id": number,
                    "topic": channel.name,
                    "encoding": "json",
                    "schemaName": channel.type,
                    "schema": schema_text(channel),
                    "schemaEncoding": "jsonschema",
                }
                for number, channel in self._channels.items()
            ],
        )
        self._answer(op="advertiseServices", services=advertise_services())
        # Now, and not the sample's time: where time goes back, programs empty their charts and logs.
        self._follow(CLOCK, lambda _: [_TIME.pack(TIME, self._doors.utc_ns())])
        self._follow(CHANGED, lambda _: self._parameter_changes())

    def _follow(self, name: str, form: Callable[[ChannelMessage], list[bytes | str]]) -> None:
        """Send data with each message of a hidden channel."""
        subscription = DoorSubscription(self._door.publisher.channels[name], form)
        self.client.subscriptions[name] = subscription
        self._door.publisher.subscribe(self.client, subscription)

    def act(self, message: str | bytes) -> None:
        """Act on a message. Raise UnusableMessageError."""
        if isinstance(message, bytes):
            self._act_on_bytes(message)
            return
        request = mapping_of(read_json(message, "A message of text"), "A message")
        name = request.get("op")
        operation = self._operations.get(name) if isinstance(name, str) else None
        if operation is None:
            raise UnusableMessageError(f"Unknown op {json.dumps(name)[:80]}.")
        operation(request)

    def _act_on_bytes(self, data: bytes) -> None:
        try:
            if data[:1] == bytes([PUBLISHED]):
                _, number = _PUBLISHED.unpack_from(data)
                self._take_published(number, data[_PUBLISHED.size :])
            elif data[:1] == bytes([SERVICE_CALL]):
                _, service, call, size = _SERVICE.unpack_from(data)
                start = _SERVICE.size + size
                self._call_service(service, call, data[_SERVICE.size : start], data[start:])
            else:
                raise UnusableMessageError("Unknown kind of binary message; there are 1 and 2.")
        except error as problem:
            raise UnusableMessageError("A binary message is cut off.") from problem

    def _subscribe(self, request: dict[str, Any]) -> None:
        try:
            for entry in _list(request, "subscriptions"):
                self._subscribe_one(mapping_of(entry, "A subscription"))
        finally:
            # Those before one that is refused hold.
            self._doors.count_audience()

    def _subscribe_one(self, asked: dict[str, Any]) -> None:
        number, channel = _number(asked, "id"), self._channels.get(_number(asked, "channelId"))
        if channel is None:
            raise UnusableMessageError(f"There is no channel {asked['channelId']}.")
        if number in self.client.subscriptions:
            raise UnusableMessageError(f"The subscription {number} exists already.")
        if len(self.client.subscriptions) >= SUBSCRIPTIONS_MAX:
            raise UnusableMessageError(f"A program may have {SUBSCRIPTIONS_MAX} subscriptions.")
        subscription = DoorSubscription(channel, _form(number))
        self.client.subscriptions[number] = subscription
        self._door.publisher.greet(self.client, subscription, self._doors.newest())
        self._door.publisher.subscribe(self.client, subscription)

    def _unsubscribe(self, request: dict[str, Any]) -> None:
        try:
            for number in _list(request, "subscriptionIds"):
                subscription = self.client.subscriptions.pop(_whole(number), None)
                if subscription is not None:
                    self._door.publisher.unsubscribe(subscription)
        finally:
            self._doors.count_audience()

    def _advertise(self, request: dict[str, Any]) -> None:
        for entry in _list(request, "channels"):
            asked = mapping_of(entry, "A channel")
            number, topic = _number(asked, "id"), text_of(asked.get("topic"), "topic")
            if topic not in TAKEN_IN:
                self._unusable[number] = topic
                continue
            if asked.get("encoding") != "json":
                raise UnusableMessageError(f"{topic} is taken in as json alone.")
            if type_name(text_of(asked.get("schemaName"), "schemaName")) != TAKEN_IN[topic]:
                raise UnusableMessageError(f"{topic} has the type {TAKEN_IN[topic]}.")
            self._published[number] = topic
        self._note_published()

    def _unadvertise(self, request: dict[str, Any]) -> None:
        for number in _list(request, "channelIds"):
            self._published.pop(_whole(number), None)
            self._unusable.pop(number, None)
        self._note_published()

    def _note_published(self) -> None:
        if len(self._published) + len(self._unusable) > SUBSCRIPTIONS_MAX:
            self._published.clear()
            self._unusable.clear()
            raise UnusableMessageError(f"A program may advertise {SUBSCRIPTIONS_MAX} channels.")

    def _take_published(self, number: int, payload: bytes) -> None:
        topic = self._published.get(number)
        if topic == STOP_TOPIC:
            self.begin(self._stop(), always=True)
        elif topic == CMD_VEL:
            linear, angular = read_twist(read_json(payload, "The payload"))
            try:
                self._commands.drive(self._pilot, linear, angular)
            except REFUSALS as problem:
                self._say(ERROR, f"{CMD_VEL}: {problem}", "drive")
        elif number in self._unusable:
            refused = self._unusable[number]
            raise UnusableMessageError(f"Programs may publish {', '.join(TAKEN_IN)}, and not {refused}.")
        else:
            raise UnusableMessageError(f"The channel {number} is not advertised.")

    async def _stop(self) -> None:
        try:
            await self._commands.perform(self._pilot, STOP, {})
        except REFUSALS as problem:
            self._say(ERROR, f"STOP has not been confirmed: {problem}")

    def _call_service(self, service: int, call: int, encoding: bytes, payload: bytes) -> None:
        name = SERVICES.get(service)
        if name == STOP:
            self.begin(self._answer_call(service, call, name, {}), always=True)  # whatever the message is
            return
        try:
            if name is None:
                raise UnusableMessageError(f"There is no service {service}.")
            if encoding != b"json":
                raise UnusableMessageError("Services take json alone.")
            fields = mapping_of(read_json(payload, "The payload") if payload else {}, "A request")
            self.begin(self._answer_call(service, call, name, fields))
        except UnusableMessageError as problem:
            self._fail_call(service, call, str(problem))

    async def _answer_call(self, service: int, call: int, name: str, fields: dict[str, Any]) -> None:
        try:
            text = await self._commands.perform(self._pilot, name, fields)
        except REFUSALS as problem:
            self._fail_call(service, call, str(problem))
            return
        payload = encode_json({"success": True, "message": text}).encode()
        self.client.answer(_SERVICE.pack(SERVICE_ANSWER, service, call, 4) + b"json" + payload)

    def _fail_call(self, service: int, call: int, why: str) -> None:
        self._answer(op="serviceCallFailure", serviceId=service, callId=call, message=why)

    def _get_parameters(self, request: dict[str, Any]) -> None:
        self._send_parameters(_names(request), request.get("id"))

    def _set_parameters(self, request: dict[str, Any]) -> None:
        given = [mapping_of(entry, "A parameter") for entry in _list(request, "parameters")]
        values = {
            text_of(parameter.get("name"), "name"): _typed(parameter.get("value")) for parameter in given
        }
        if not values:
            raise UnusableMessageError("setParameters needs one parameter at least.")
        self.begin(self._perform_set(values, request.get("id")))

    async def _perform_set(self, values: dict[str, Any], identifier: object) -> None:
        whole = {name for name, parameter in self._doors.parameters().items() if parameter["type"] == "whole"}
        values = {
            name: int(value) if name in whole and isinstance(value, float) and value.is_integer() else value
            for name, value in values.items()
        }
        try:
            await self._commands.set_parameters(self._pilot, values)
        except REFUSALS as problem:
            self._say(ERROR, f"The parameters were not set: {problem}", "parameters")
            self._send_parameters([*values], identifier)
            return
        if identifier is not None:
            self._send_parameters([*values], identifier)

    def _watch_parameters(self, request: dict[str, Any]) -> None:
        current = self._doors.parameters()
        # The names of the robot's parameters alone: nobody fills the memory with others.
        added = (set(_names(request)) & current.keys()) - self._watched
        self._watched |= added
        # What the program has not been sent yet of the others stays so.
        self._known |= {name: current[name]["value"] for name in added}

    def _forget_parameters(self, request: dict[str, Any]) -> None:
        self._watched -= set(_names(request))

    def _parameter_changes(self) -> list[bytes | str]:
        current = self._doors.parameters()
        changed = [
            _parameter(parameter)
            for name, parameter in current.items()
            if name in self._watched and self._known.get(name) != parameter["value"]
        ]
        self._known = {name: parameter["value"] for name, parameter in current.items()}
        return [encode_json({"op": "parameterValues", "parameters": changed})] if changed else []

    def _send_parameters(self, names: list[str], identifier: object) -> None:
        """Send the values of these parameters; of all where none is named."""
        current = self._doors.parameters()
        listed = [_parameter(parameter) for name, parameter in current.items() if not names or name in names]
        self._answer(op="parameterValues", parameters=listed, **_with(identifier))

    def _say(self, level: int, text: str, identifier: str = "") -> None:
        self._answer(op="status", level=level, message=text, **_with(identifier or None))

    def _answer(self, **message: Any) -> None:
        self.client.answer(encode_json(message))


def choose_subprotocol(offered: list[str]) -> str | None:
    """Return the first known subprotocol among the offered ones; None without one."""
    return next((protocol for protocol in offered if protocol in SUBPROTOCOLS), None)


def _form(number: int) -> Callable[[ChannelMessage], list[bytes | str]]:
    return lambda message: [_MESSAGE.pack(MESSAGE, number, message.time) + message.json.encode()]


def _parameter(parameter: Mapping[str, Any]) -> dict[str, Any]:
    number = parameter["type"] == "number"
    return {"name": parameter["name"], "value": parameter["value"], **({"type": "float64"} if number else {})}


def _typed(value: Any) -> Any:
    if not isinstance(value, bool | int | float | str):
        raise UnusableMessageError("A parameter's value is a number, a text, true or false.")
    return value


def _with(identifier: object) -> dict[str, str]:
    return {"id": identifier[:NAME_MAX]} if isinstance(identifier, str) else {}


def _list(request: dict[str, Any], name: str) -> list[Any]:
    value = request.get(name)
    if not isinstance(value, list):
        raise UnusableMessageError(f"{name} must be a list.")
    return value


def _names(request: dict[str, Any]) -> list[str]:
    return [text_of(entry, "A parameter's name") for entry in _list(request, "parameterNames")]


def _number(request: dict[str, Any], name: str) -> int:
    return _whole(request.get(name), name)


def _whole(value: object, name: str = "id") -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= NUMBER_MAX:
        raise UnusableMessageError(f"{name} must be a whole number from 0 to {NUMBER_MAX}.")
    return value
