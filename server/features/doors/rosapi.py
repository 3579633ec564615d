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
    """The services that command the robot, and their types."""
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
    """Answers one program's service calls."""

    def __init__(self, doors: Doors, door: Door, commands: DoorCommands, pilot: DoorPilot) -> None:
        self._doors = doors
        self._door = door
        self._commands = commands
        self._pilot = pilot
        self._types = {name: one.type for name, one in door.publisher.channels.items()} | TAKEN_IN
        self._answers: dict[str, Callable[[dict[str, Any]], dict[str, Any]]] = {
            "topics": lambda _: {"topics": [*self._types], "types": [*self._types.values()]},
            "topics_for_type": lambda said: {"topics": _of_type(self._types, said)},
            "topic_type": lambda said: {"type": self._types.get(name_of(said, "topic"), "")},
            "services": lambda _: {"services": [*SERVICES]},
            "services_for_type": lambda said: {"services": _of_type(SERVICES, said)},
            "service_type": lambda said: {"type": SERVICES.get(name_of(said, "service"), "")},
            "service_node": lambda said: {"node": NODE if name_of(said, "service") in SERVICES else ""},
            "service_host": lambda said: {
                "host": doors.robot if name_of(said, "service") in SERVICES else ""
            },
            "nodes": lambda _: {"nodes": [NODE, *self._nodes()]},
            "node_details": self._describe_node,
            "publishers": self._publishers,
            "subscribers": self._subscribers,
            "get_param_names": lambda _: {"names": [*self._parameters()]},
            "get_param": self._get_parameter,
            "has_param": lambda said: {"exists": _parameter(said) in self._parameters()},
            "get_time": lambda _: {"time": stamp(doors.utc_ns())},
        }

    def arguments(self, name: str, given: object) -> dict[str, Any]:
        """A call's arguments by name; rosbridge also lets them be a list. Raises UnusableMessageError."""
        if isinstance(given, list):
            names = ARGUMENTS.get(name.removeprefix(ROSAPI), ())
            if len(given) > len(names):
                raise UnusableMessageError(f"{name} takes its arguments by name.")
            return dict(zip(names, given, strict=False))
        return mapping_of({} if given is None else given, "args")

    async def call(self, name: str, said: dict[str, Any]) -> dict[str, Any]:
        """Answer a call. Raises UnusableMessageError, and what `DoorCommands` raises."""
        if name.startswith(ROSAPI):
            own = name.removeprefix(ROSAPI)
            if own == "set_param":
                return await self._set_parameter(said)
            if own in self._answers:
                return self._answers[own](said)
            raise UnusableMessageError(REFUSED.get(own, f"There is no service {name}."))
        if name not in SERVICES:
            raise UnusableMessageError(f"There is no service {name}; /rosapi/services lists them.")
        text = await self._commands.perform(self._pilot, name.removeprefix(f"{NODE}/"), said)
        return {"success": True, "message": text}

    def _parameters(self) -> dict[str, Any]:
        return {name: one["value"] for name, one in self._doors.parameters().items()}

    def _get_parameter(self, said: dict[str, Any]) -> dict[str, Any]:
        name, values = _parameter(said), self._parameters()
        if name in values:
            return {"value": json.dumps(values[name])}
        if said.get("default") not in (None, ""):
            return {"value": said["default"]}
        raise UnusableMessageError(f"There is no parameter {name}; /rosapi/get_param_names lists them.")

    async def _set_parameter(self, said: dict[str, Any]) -> dict[str, Any]:
        name = _parameter(said)
        value = read_json(text_of(said.get("value"), "value"), "value")
        await self._commands.set_parameters(self._pilot, {name: value})
        return {}

    def _nodes(self) -> dict[str, Any]:
        return {f"/client_{client.number}": client for client in self._door.clients}

    def _publishers(self, said: dict[str, Any]) -> dict[str, Any]:
        name = name_of(said, "topic")
        own = [NODE] if name in self._door.publisher.channels else []
        others = [
            node for node, one in self._nodes().items() if name in self._door.published.get(one, frozenset())
        ]
        return {"publishers": own + others}

    def _subscribers(self, said: dict[str, Any]) -> dict[str, Any]:
        name = name_of(said, "topic")
        own = [NODE] if name in TAKEN_IN else []
        others = [node for node, one in self._nodes().items() if name in one.subscriptions]
        return {"subscribers": own + others}

    def _describe_node(self, said: dict[str, Any]) -> dict[str, Any]:
        name = name_of(said, "node")
        if name == NODE:
            return {
                "subscribing": [*TAKEN_IN],
                "publishing": [*self._door.publisher.channels],
                "services": [*SERVICES],
            }
        client = self._nodes().get(name)
        if client is None:
            raise UnusableMessageError(f"There is no node {name}; /rosapi/nodes lists them.")
        published = self._door.published.get(client, frozenset())
        return {"subscribing": [*client.subscriptions], "publishing": sorted(published), "services": []}


def name_of(said: dict[str, Any], key: str) -> str:
    """The name of a topic or service, which begins with a slash: roslib 2 leaves it out of rosapi's.

    Raises UnusableMessageError.
    """
    name = text_of(said.get(key), key)
    return name if name.startswith("/") else f"/{name}"


def _parameter(said: dict[str, Any]) -> str:
    """A parameter's name; ROS 1 puts a slash before it, and ROS 2 the node and a colon."""
    return text_of(said.get("name"), "name").removeprefix(f"{NODE}:").removeprefix("/")


def _of_type(types: dict[str, str], said: dict[str, Any]) -> list[str]:
    asked = text_of(said.get("type"), "type")
    package, _, rest = asked.partition("/")
    names = {asked, type_name(asked), f"{package}/srv/{rest}"}
    return [name for name, kind in types.items() if kind in names]
