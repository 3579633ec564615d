"""The robot's commands as services of Foxglove's protocol, with JSON Schemas of their requests."""

import json
from typing import Any

from pydantic import TypeAdapter

from server.features.doors.commands import COMMANDS, TAKE
from server.features.doors.rosapi import NODE, command_services
from server.interchange.plain_schema import simplify

_TYPES = command_services()
SERVICES: dict[int, str] = dict(enumerate((name.removeprefix(f"{NODE}/") for name in _TYPES), 1))
"""The names of the commands by the services' numbers."""
EMPTY = {"type": "object", "properties": {}}
TAKE_SCHEMA = {"type": "object", "properties": {"over": {"type": "boolean"}}}
ANSWER = {"type": "object", "properties": {"success": {"type": "boolean"}, "message": {"type": "string"}}}


def advertise_services() -> list[dict[str, Any]]:
    """Return the services as `advertiseServices` lists them."""
    return [
        {
            "id": number,
            "name": f"{NODE}/{name}",
            "type": _TYPES[f"{NODE}/{name}"],
            **_definitions("request", f"{name}_request", _request_schema(name)),
            **_definitions("response", "answer", ANSWER),
        }
        for number, name in SERVICES.items()
    ]


def _request_schema(name: str) -> dict[str, Any]:
    if name in COMMANDS:
        return simplify(TypeAdapter(COMMANDS[name]).json_schema())
    return TAKE_SCHEMA if name == TAKE else EMPTY


def _definitions(of: str, name: str, schema: dict[str, Any]) -> dict[str, Any]:
    """Return the schema, also in the form for programs older than the protocol's `request`."""
    text = json.dumps(schema)
    whole = {
        "encoding": "json",
        "schemaName": f"mucat.{name}",
        "schemaEncoding": "jsonschema",
        "schema": text,
    }
    return {of: whole, f"{of}Schema": text}
