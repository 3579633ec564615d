"""Numbers in bodies: only a finite number of JSON is one."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from fastapi.routing import iter_route_contexts
from pydantic import TypeAdapter, ValidationError

from server.app import create_app
from server.platform.settings import DataFolder, Settings

NO_NUMBERS = [True, "1", "1.5", float("inf"), float("nan")]
NUMBERS = {"number", "integer"}
DEPTH_MAX = 8

Place = tuple[str | int, ...]


def bodies() -> Iterator[tuple[str, TypeAdapter[Any]]]:
    """Yield the name and the schema of each operation's body."""
    app = create_app(Settings(data=DataFolder(Path("data")), config=Path("robot.toml"), every_feature=True))
    for route in iter_route_contexts([*app.routes]):
        field = getattr(route, "body_field", None)
        if field is not None:
            yield str(getattr(route, "operation_id", "")), TypeAdapter(field.field_info.annotation)


def list_numbers(schema: dict[str, Any], whole: dict[str, Any], position: Place = ()) -> Iterator[Place]:
    """Yield the places of the numbers in documents of a schema; keys and items are the first ones."""
    if len(position) > DEPTH_MAX:
        return
    if "$ref" in schema:
        schema = whole["$defs"][schema["$ref"].rsplit("/", 1)[1]]
    options = schema.get("anyOf", schema.get("oneOf", [schema]))
    if any(option.get("type") in ("string", "boolean") for option in options):
        return
    for item in options:
        if item.get("type") in NUMBERS:
            yield position
        if item is not schema:
            yield from list_numbers(item, whole, position)
    for name, inner in schema.get("properties", {}).items():
        yield from list_numbers(inner, whole, (*position, name))
    if isinstance(inner := schema.get("additionalProperties"), dict):
        yield from list_numbers(inner, whole, (*position, "key"))
    if "items" in schema:
        yield from list_numbers(schema["items"], whole, (*position, 0))
    for index, inner in enumerate(schema.get("prefixItems", [])):
        yield from list_numbers(inner, whole, (*position, index))


def document(position: Place, value: object) -> object:
    """Return a document with nothing but the value at its place."""
    for step in reversed(position):
        value = {step: value} if isinstance(step, str) else [value] * (step + 1)
    return value


def kinds(adapter: TypeAdapter[Any], content: object, position: Place) -> set[str]:
    """Return the errors of a value at a place, without those that a document has anyway."""
    try:
        adapter.validate_python(content)
    except ValidationError as problem:
        return {
            str(error["type"])
            for error in problem.errors(include_url=False)
            # Unions add their alternatives to the places, and errors of those that have no such field.
            if tuple(step for step in error["loc"] if step in position) == position
            and error["type"] != "extra_forbidden"
        }
    return set()


def test_what_is_no_finite_number_is_refused_in_every_body() -> None:
    accepted, asked = [], set()
    for name, adapter in bodies():
        for position in dict.fromkeys(list_numbers(schema := adapter.json_schema(), schema)):
            asked.add((name, *position))
            for value in NO_NUMBERS:
                content = document(position, value)
                if not kinds(adapter, content, position):
                    accepted.append((name, position, str(value)[:10]))
    assert accepted == []
    assert {
        ("makeToken", "days"),
        ("startTuningRun", "amplitude"),
        ("commandArm", "alone"),
        ("commandLoop", "set_point"),
        ("commandLoop", "gains", "key"),
        ("commandVisionSettings", "colours", "key", "hue", 1),
        ("saveLayout", "document", "panels", 0, "chart", "seconds"),
        ("compareSessions", "view", "start"),
        ("addMark", "time"),
    } <= asked
