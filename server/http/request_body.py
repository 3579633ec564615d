"""The base of all bodies that a request may have."""

from pydantic import ConfigDict

from server.platform.schema_base import Schema


class RequestBody(Schema):
    """The body of a request: it refuses unknown fields, and values that are not of their type already."""

    model_config = ConfigDict(extra="forbid", strict=True, defer_build=False)
