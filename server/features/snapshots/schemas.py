"""Schemas of snapshots in the interface."""

from pydantic import Field

from server.platform.schema_base import Schema


class TakenSnapshot(Schema):
    """A snapshot that has just been stored."""

    session: int = Field(description="the session that keeps it")
    time: float = Field(description="s since the session's start")
