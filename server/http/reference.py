"""docs/reference/http.md: the operations of the HTTP interface and what they take, from the OpenAPI document.

Types of requests are described field by field; the fields of answers are in the OpenAPI document alone.
The commands of the robot are described in commands.md.
"""

from collections.abc import Callable, Iterator, Mapping
from typing import Any, cast

from robot_runtime.contract.commands import COMMANDS
from robot_runtime.generate.markdown import entry, fill, page
from server.http.sign_in.policy import DECLARED

Schema = Mapping[str, Any]

SOURCE = "the server's OpenAPI document"
COMMANDS_PATH = "/api/robot/commands/"
COMMAND_TYPES = {cls.__name__: name for name, cls in COMMANDS.items()}
LARGEST = 2.0**63 - 1
"""The largest identifier of the database, which is no limit to a person."""


def http_page(document: Schema) -> str:
    """Return the whole text of http.md."""
    operations = [
        (f"{method.upper()} {path}", operation)
        for path, methods in document["paths"].items()
        if not path.startswith(COMMANDS_PATH)
        for method, operation in methods.items()
    ]
    types = document["components"]["schemas"]
    sent = _reach(
        types, {name for _, operation in operations for name in _names(operation.get("requestBody"))}
    )
    parts = [fill("http")]
    for tag in dict.fromkeys(tag for _, operation in operations for tag in operation["tags"]):
        lines = [_operation(name, operation) for name, operation in operations if tag in operation["tags"]]
        parts += [f"## {tag[0].upper()}{tag[1:]}\n", "".join(lines)]
    parts.append("## Types of requests\n")
    for name in filter((sent - COMMAND_TYPES.keys()).__contains__, types):
        parts += [f"### {name}\n", _sent(types[name])]
    return page("HTTP", SOURCE, *parts)


def _reach(types: Schema, start: set[str]) -> set[str]:
    """Return the names of types and of all types within them."""
    reached: set[str] = set()
    while start:
        reached |= start
        start = {inner for name in start for inner in _names(types[name])} - reached
    return reached


def _names(schema: object) -> Iterator[str]:
    """Yield the names of the types that a part of the document refers to."""
    if isinstance(schema, dict):
        if "$ref" in schema:
            yield schema["$ref"].rpartition("/")[2]
        schema = list(schema.values())
    if isinstance(schema, list):
        for part in schema:
            yield from _names(part)


def _operation(name: str, operation: Schema) -> str:
    summary, description = operation["summary"], operation.get("description", "")
    meaning = description if description.startswith(summary) else f"{summary}. {description}"
    answers = ", ".join(_answers(operation))
    return entry(
        name,
        (operation[DECLARED], ", ".join(_request(operation)), answers and f"gives {answers}"),
        " ".join(meaning.split()),
    )


def _request(operation: Schema) -> Iterator[str]:
    for parameter in operation.get("parameters", ()):
        if parameter["in"] == "query":
            yield f"`?{parameter['name']}`" + (" (required)" if parameter.get("required") else "")
    yield from _contents(operation.get("requestBody", {}), _link)


def _answers(operation: Schema) -> Iterator[str]:
    """Yield the answers of a success; refusals are the same for all operations."""
    for status, response in operation["responses"].items():
        if status.startswith("2"):
            shown = "" if status == "200" else f"{status} "
            yield from (f"{shown}{content}" for content in _contents(response, "`{}`".format))


def _contents(body: Schema, name_type: Callable[[str], str]) -> Iterator[str]:
    for media_type, content in body.get("content", {}).items():
        json = "schema" in content and media_type == "application/json"
        yield _describe(content["schema"], name_type) if json else f"`{media_type}`"


def _sent(schema: Schema) -> str:
    """Return the text of a request's type: a line for each field, or what it is."""
    required = schema.get("required", ())
    lines = []
    for name, field in schema.get("properties", {}).items():
        type_ = _describe(field) + ("" if name in required else ", optional")
        lines.append(entry(name, (type_,), " ".join(field.get("description", "").split())))
    return "".join(lines) or _describe(schema) + "\n"


def _link(name: str) -> str:
    if command := COMMAND_TYPES.get(name):
        return f"[{name}](commands.md#{command})"
    return f"[{name}](#{name.lower()})"


def _describe(schema: Schema, name_type: Callable[[str], str] = _link) -> str:
    """Return a schema's short description."""
    if reference := schema.get("$ref"):
        return name_type(cast("str", reference).rpartition("/")[2])
    for key in ("anyOf", "oneOf"):
        if choices := schema.get(key):
            return " or ".join(dict.fromkeys(_describe(choice, name_type) for choice in choices))
    if values := schema.get("enum"):
        return ", ".join(f"`{value}`" for value in values)
    if "const" in schema:
        return f"`{schema['const']}`"
    match schema.get("type"):
        case "array":
            return f"list of {_describe(schema['items'], name_type)}" if "items" in schema else "list"
        case "object":
            values = schema.get("additionalProperties")
            return (
                f"object of {_describe(values, name_type)}"
                if isinstance(values, dict) and values
                else "object"
            )
        case "integer" | "number" as kind:
            return " ".join(
                filter(None, ("whole number" if kind == "integer" else "number", _limits(schema)))
            )
        case "string":
            return {"date-time": "UTC time (ISO 8601)"}.get(schema.get("format", ""), "text")
        case "boolean":
            return "true or false"
        case "null":
            return "null"
    return "any"


def _limits(schema: Schema) -> str:
    low = schema.get("minimum", schema.get("exclusiveMinimum"))
    high = schema.get("maximum", schema.get("exclusiveMaximum"))
    if high is not None and high >= LARGEST:
        high = None
    if low is None or high is None:
        return f"from {low:g}" if low is not None else f"up to {high:g}" if high is not None else ""
    return f"{low:g} to {high:g}"
