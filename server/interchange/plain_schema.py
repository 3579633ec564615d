"""JSON Schemas as Foxglove and Lichtblick read them: no references, no alternatives, one type for each field.

Their parser refuses others with an error that also costs the program all services listed after it. A field
that may be null has the type of its other values: messages leave it out instead (`without_null`). A field
that it cannot express, such as one of numbers or text, is not in the schema; the messages hold it.
"""

from collections.abc import Mapping, Sequence
from typing import Any

_SIMPLE = ("boolean", "integer", "number", "string")


def simplify(schema: Mapping[str, Any]) -> dict[str, Any]:
    """Return the schema of an object without the fields that it cannot express."""
    return _object(schema, schema.get("$defs", {}))


def without_null(value: Any) -> Any:
    """Return a message without its members that are null, at any depth."""
    if isinstance(value, Mapping):
        return {key: without_null(item) for key, item in value.items() if item is not None}
    if isinstance(value, list | tuple):
        return [without_null(item) for item in value]
    return value


def _object(schema: Mapping[str, Any], definitions: Mapping[str, Any]) -> dict[str, Any]:
    fields = {name: _plain(inner, definitions) for name, inner in schema.get("properties", {}).items()}
    return {
        "type": "object",
        "properties": {name: inner for name, inner in fields.items() if inner is not None},
    }


def _plain(schema: Mapping[str, Any], definitions: Mapping[str, Any]) -> dict[str, Any] | None:
    if "$ref" in schema:
        return _plain(definitions[schema["$ref"].rpartition("/")[2]], definitions)
    if "anyOf" in schema:
        there = [option for option in schema["anyOf"] if option.get("type") != "null"]
        return _described(_common(there, definitions), schema)
    kind = schema.get("type")
    if kind == "object":
        return _described(_object(schema, definitions), schema)
    if kind == "array":
        items = _common(schema.get("prefixItems") or [schema.get("items", {})], definitions)
        # An array of arrays has no place there.
        usable = items is not None and items["type"] != "array"
        return _described({"type": "array", "items": items}, schema) if usable else None
    return _described({"type": kind}, schema) if kind in _SIMPLE else None


def _common(
    alternatives: Sequence[Mapping[str, Any]], definitions: Mapping[str, Any]
) -> dict[str, Any] | None:
    """Return the common schema of all of these; whole numbers are numbers, too."""
    plain = [_plain(alternative, definitions) for alternative in alternatives]
    if len(plain) == 1:
        return plain[0]
    kinds = {"" if entry is None else entry["type"] for entry in plain}
    if kinds == {"integer", "number"}:
        return {"type": "number"}
    return {"type": kinds.pop()} if len(kinds) == 1 and kinds <= {*_SIMPLE} else None


def _described(plain: dict[str, Any] | None, schema: Mapping[str, Any]) -> dict[str, Any] | None:
    text = schema.get("description")
    return plain if plain is None or text is None else plain | {"description": text}
