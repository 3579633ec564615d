"""Schemas of profiles of parameters, and of undo."""

from datetime import datetime
from typing import Annotated

from pydantic import Field, StringConstraints

from server.driving.schemas import Value
from server.http.request_body import RequestBody
from server.platform.schema_base import Schema

PARAMETERS_MAX = 1000

ParameterName = Annotated[str, StringConstraints(min_length=1, max_length=100)]
Values = Annotated[dict[ParameterName, Value], Field(max_length=PARAMETERS_MAX)]
ProfileName = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=100)]
ProfileNote = Annotated[str, StringConstraints(strip_whitespace=True, max_length=1000)]


class Undo(RequestBody):
    """The change to undo: the newest that is not undone."""

    change: int


class Profile(Schema):
    """Parameters saved under a name."""

    id: int
    name: str
    note: str
    author: str = Field(description="the person who saved it; empty where it is not known")
    saved: datetime = Field(description="UTC")
    values: dict[str, Value]


class NewProfile(RequestBody):
    """The name under which the present parameters are saved."""

    name: ProfileName
    note: ProfileNote = ""


class ProfileText(RequestBody):
    """A profile's file, as text."""

    text: Annotated[str, Field(max_length=200_000)]


class Imported(Schema):
    """An imported profile, and its parameters that this robot does not know."""

    profile: Profile
    unknown: list[str]
