"""The services of the rosbridge door: rosapi, and the robot's commands."""

import json
from collections.abc import Callable
from dataclasses import fields
from typing import Any

from server.features.doors.commands import (
    COMMANDS,
    RELEASE,
    STOP,
    TAKE,
    DoorCommands,
    DoorPilot,
)
from server.features.doors.house import Door, Doors
from server.features.doors.ros2_messages import TRIGGER
from server.features.doors.ros_channels import stamp, type_name
from server.features.doors.session import UnusableMessageError, mapping_of, read_json, text_of
from server.features.doors.subscriptions import DoorClient
from server.features.doors.twist import TAKEN_IN

NODE = "/mucat"
ARGUMENTS: dict[str, tuple[str, ...]] = {
    "topics": (),
    "topics_for_type": ("type",),
    "topic_type": ("topic",),
    "services": (),
    "services_for_type": ("type",),
    "service_type": ("service",),
    "service_node": ("service",),
    "service_host": ("service",),
    "nodes": (),
    "node_details": ("node",),
    "publishers": ("topic",),
    "subscribers": ("topic",),
    "get_param_names": (),
    "get_param": ("name", "default"),
    "has_param": ("name",),
    "set_param": ("name", "value"),
    "get_time": (),
}
"""The services of rosapi, and their arguments in order."""
REFUSED = {
    "delete_param": "Parameters of the robot cannot be deleted.",
    "search_param": "Parameters have one name each; get_param_names lists them.",
    "message_details": "Types are described in the manual: docs/reference/doors.md.",
    "service_request_details": "Types are described in the manual: docs/reference/commands.md.",
    "service_response_details": "A command answers with success and message.",
    "topics_and_raw_types": "Definitions of types are not sent; use /foxglove, which sends schemas.",
    "action_servers": "There are no actions here; commands are services.",
}
ROSAPI = "/rosapi/"


def command_services() -> dict[str, str]:
    """Return the services that command the robot, and their types."""
    plain = dict.fromkeys((STOP, RELEASE), TRIGGER)
    commands = {
        name: f"mucat/srv/{name.title().replace('_', '')}" if fields(cls) else TRIGGER
        for name, cls in COMMANDS.items()
    }
    everything = {**plain, TAKE: "mucat/srv/TakeControl", **commands}
    return {f"{NODE}/{name}": kind for name, kind in everything.items()}


SERVICES = command_services() | {
    ROSAPI + name: f"rosapi_msgs/srv/{name.title().replace('_', '')}" for name in ARGUMENTS
}


class RosApi:
    """The service calls of one program."""

    def __init__(self, doors: Doors, door: Door, commands: DoorCommands, pilot: DoorPilot) -> None:
        self._doors = doors
        self._door = door
        self._commands = commands
        self._pilot = pilot
        self._types = {name: channel.type for name, channel in door.publisher.channels.items()} | TAKEN_IN
        self._answers: dict[str, Callable[[dict[str, Any]], dict[str, Any]]] = {
            "topics": lambda _: {"topics": [*self._types], "types": [*self._types.values()]},
            "topics_for_type": lambda request: {"topics": _of_type(self._types, request)},
            "topic_type": lambda request: {"type": self._types.get(name_of(request, "topic"), "")},
            "services": lambda _: {"services": [*SERVICES]},
            "services_for_type": lambda request: {"services": _of_type(SERVICES, request)},
            "service_type": lambda request: {"type": SERVICES.get(name_of(request, "service"), "")},
            "service_node": lambda request: {"node": NODE if name_of(request, "service") in SERVICES else ""},
            "service_host": lambda request: {
                "host": doors.robot if name_of(request, "service") in SERVICES else ""
            },
            "nodes": lambda _: {"nodes": [NODE, *self._nodes()]},
            "node_details": self._describe_node,
            "publishers": self._publishers,
            "subscribers": self._subscribers,
            "get_param_names": lambda _: {"names": [*self._parameters()]},
            "get_param": self._get_parameter,
            "has_param": lambda request: {"exists": _parameter(request) in self._parameters()},
            "get_time": lambda _: {"time": stamp(doors.utc_ns())},
        }

    def arguments(self, name: str, given: object) -> dict[str, Any]:
        """Return a call's arguments by name; rosbridge also allows a list. Raise UnusableMessageError."""
        if isinstance(given, list):
            names = ARGUMENTS.get(name.removeprefix(ROSAPI), ())
            if len(given) > len(names):
                raise UnusableMessageError(f"{name} takes its arguments by name.")
            return dict(zip(names, given, strict=False))
        return mapping_of({} if given is None else given, "args")

    async def call(self, name: str, request: dict[str, Any]) -> dict[str, Any]:
        """Answer a call. Raise UnusableMessageError, and the errors of `DoorCommands`."""
        if name.startswith(ROSAPI):
            own = name.removeprefix(ROSAPI)
            if own == "set_param":
                return await self._set_parameter(request)
            if own in self._answers:
                return self._answers[own](request)
            raise UnusableMessageError(REFUSED.get(own, f"There is no service {name}."))
        if name not in SERVICES:
            raise UnusableMessageError(f"There is no service {name}; /rosapi/services lists them.")
        text = await self._commands.perform(self._pilot, name.removeprefix(f"{NODE}/"), request)
        return {"success": True, "message": text}

    def _parameters(self) -> dict[str, Any]:
        return {name: parameter["value"] for name, parameter in self._doors.parameters().items()}

    def _get_parameter(self, request: dict[str, Any]) -> dict[str, Any]:
        name, values = _parameter(request), self._parameters()
        if name in values:
            return {"value": json.dumps(values[name])}
        if request.get("default") not in (None, ""):
            return {"value": request["default"]}
        raise UnusableMessageError(f"There is no parameter {name}; /rosapi/get_param_names lists them.")

    async def _set_parameter(self, request: dict[str, Any]) -> dict[str, Any]:
        name = _parameter(request)
        value = read_json(text_of(request.get("value"), "value"), "value")
        await self._commands.set_parameters(self._pilot, {name: value})
        return {}

    def _nodes(self) -> dict[str, DoorClient]:
        return {f"/client_{client.number}": client for client in self._door.clients}

    def _publishers(self, request: dict[str, Any]) -> dict[str, Any]:
        name = name_of(request, "topic")
        own = [NODE] if name in self._door.publisher.channels else []
        others = [node for node, client in self._nodes().items() if name in client.published]
        return {"publishers": own + others}

    def _subscribers(self, request: dict[str, Any]) -> dict[str, Any]:
        name = name_of(request, "topic")
        own = [NODE] if name in TAKEN_IN else []
        others = [node for node, client in self._nodes().items() if name in client.subscriptions]
        return {"subscribers": own + others}

    def _describe_node(self, request: dict[str, Any]) -> dict[str, Any]:
        name = name_of(request, "node")
        if name == NODE:
            return {
                "subscribing": [*TAKEN_IN],
                "publishing": [*self._door.publisher.channels],
                "services": [*SERVICES],
            }
        client = self._nodes().get(name)
        if client is None:
            raise UnusableMessageError(f"There is no node {name}; /rosapi/nodes lists them.")
        return {
            "subscribing": [*client.subscriptions],
            "publishing": sorted(client.published),
            "services": [],
        }


def name_of(request: dict[str, Any], key: str) -> str:
    """Return a topic's or service's name with its leading slash, which roslib 2 omits for rosapi.

    Raise UnusableMessageError.
    """
    name = text_of(request.get(key), key)
    return name if name.startswith("/") else f"/{name}"


def _parameter(request: dict[str, Any]) -> str:
    """Return a parameter's name; ROS 1 puts a slash before it, and ROS 2 the node and a colon."""
    return text_of(request.get("name"), "name").removeprefix(f"{NODE}:").removeprefix("/")


def _of_type(types: dict[str, str], request: dict[str, Any]) -> list[str]:
    asked = text_of(request.get("type"), "type")
    package, _, rest = asked.partition("/")
    names = {asked, type_name(asked), f"{package}/srv/{rest}"}
    return [name for name, kind in types.items() if kind in names]
