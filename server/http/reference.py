"""docs/reference/http.md: every operation of the HTTP interface and its types, from the OpenAPI document."""

from collections.abc import Iterator, Mapping
from typing import Any, cast

from robot_runtime.generate.markdown import fill, page, table
from server.http.sign_in.policy import DECLARED

Schema = Mapping[str, Any]

SOURCE = "the server's OpenAPI document"


def http_page(document: Schema) -> str:
    """Return the whole text of http.md."""
    operations = [
        (f"{method.upper()} {path}", operation)
        for path, methods in document["paths"].items()
        for method, operation in methods.items()
    ]
    parts = [fill("http")]
    for tag in dict.fromkeys(tag for _, operation in operations for tag in operation["tags"]):
        rows = [_row(name, operation) for name, operation in operations if tag in operation["tags"]]
        parts += [f"## {tag[0].upper()}{tag[1:]}\n"]
        parts += [table(("operation", "needs", "request", "answer", "meaning"), rows)]
    parts.append("## Types\n")
    for name, schema in document["components"]["schemas"].items():
        parts += [f"### {name}\n", *_type(schema)]
    return page("HTTP", SOURCE, *parts)


def _row(name: str, operation: Schema) -> tuple[str, ...]:
    summary, description = operation["summary"], operation.get("description", "")
    meaning = description if description.startswith(summary) else f"{summary}. {description}"
    return (
        f"`{name}`",
        operation[DECLARED],
        ", ".join(_request(operation)),
        ", ".join(_answers(operation)),
        " ".join(meaning.split()),
    )


def _request(operation: Schema) -> Iterator[str]:
    for parameter in operation.get("parameters", ()):
        if parameter["in"] == "query":
            yield f"`?{parameter['name']}`" + (" (required)" if parameter.get("required") else "")
    for content in operation.get("requestBody", {}).get("content", {}).items():
        yield _content(*content)


def _answers(operation: Schema) -> Iterator[str]:
    """Yield the answers of a success; refusals are the same for all operations."""
    for status, response in operation["responses"].items():
        if status.startswith("2"):
            contents = [_content(*content) for content in response.get("content", {}).items()]
            yield " ".join((status, *contents))


def _content(media_type: str, content: Schema) -> str:
    return (
        _describe(content["schema"])
        if "schema" in content and media_type == "application/json"
        else f"`{media_type}`"
    )


def _type(schema: Schema) -> Iterator[str]:
    if description := schema.get("description"):
        yield " ".join(description.split()) + "\n"
    required = schema.get("required", ())
    rows = [
        (
            f"`{name}`" + ("" if name in required else " (optional)"),
            _describe(field),
            " ".join(field.get("description", "").split()),
        )
        for name, field in schema.get("properties", {}).items()
    ]
    yield table(("field", "type", "meaning"), rows) if rows else _describe(schema) + "\n"


def _describe(schema: Schema) -> str:
    """Return a schema's short description; named types are links."""
    if reference := schema.get("$ref"):
        name = cast("str", reference).rpartition("/")[2]
        return f"[{name}](#{name.lower()})"
    for key in ("anyOf", "oneOf"):
        if choices := schema.get(key):
            return " or ".join(dict.fromkeys(map(_describe, choices)))
    if values := schema.get("enum"):
        return ", ".join(f"`{value}`" for value in values)
    if "const" in schema:
        return f"`{schema['const']}`"
    match schema.get("type"):
        case "array":
            return f"list of {_describe(schema['items'])}" if "items" in schema else "list"
        case "object":
            values = schema.get("additionalProperties")
            return f"object of {_describe(values)}" if isinstance(values, dict) and values else "object"
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
    if low is None or high is None:
        return f"from {low:g}" if low is not None else f"up to {high:g}" if high is not None else ""
    return f"{low:g} to {high:g}"
