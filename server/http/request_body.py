"""The base of all bodies that a request may have."""

from pydantic import BaseModel, ConfigDict


class RequestBody(BaseModel):
    """A body of a request: it has no unknown fields, and each value is of its type as it stands."""

    model_config = ConfigDict(extra="forbid", strict=True)
