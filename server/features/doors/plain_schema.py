"""JSON Schemas as Foxglove and Lichtblick read them: no references, no alternatives, a type for each field.

Their parser refuses others with an error that also costs the program all services listed after it.
"""

from collections.abc import Mapping
from typing import Any

_SIMPLE = ("boolean", "integer", "number", "string")


def simplify(schema: Mapping[str, Any]) -> dict[str, Any]:
    """The schema of an object without the fields that cannot be said so."""
    return _object(schema, schema.get("$defs", {}))


def _object(schema: Mapping[str, Any], definitions: Mapping[str, Any]) -> dict[str, Any]:
    fields = {name: _plain(one, definitions) for name, one in schema.get("properties", {}).items()}
    return {"type": "object", "properties": {name: one for name, one in fields.items() if one is not None}}


def _plain(schema: Mapping[str, Any], definitions: Mapping[str, Any]) -> dict[str, Any] | None:
    alternatives = [one for one in schema.get("anyOf", []) if one.get("type") != "null"]
    if len(alternatives) == 1:
        return _described(_plain(alternatives[0], definitions), schema)
    if "$ref" in schema:
        return _plain(definitions[schema["$ref"].rpartition("/")[2]], definitions)
    kind = schema.get("type")
    if kind == "object":
        return _described(_object(schema, definitions), schema)
    if kind == "array":
        items = _plain(schema.get("items", {}), definitions)
        # An array of arrays has no place there.
        usable = items is not None and items["type"] != "array"
        return _described({"type": "array", "items": items}, schema) if usable else None
    return _described({"type": kind}, schema) if kind in _SIMPLE else None


def _described(plain: dict[str, Any] | None, schema: Mapping[str, Any]) -> dict[str, Any] | None:
    text = schema.get("description")
    return plain if plain is None or text is None else plain | {"description": text}
