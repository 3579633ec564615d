"""Requests and answers about profiles of parameters, and undo."""

from typing import Annotated

from pydantic import Field

from server.driving.profiles import Profile, ProfileName, ProfileNote
from server.http.request_body import RequestBody
from server.platform.schema_base import Schema


class Undo(RequestBody):
    """The change to undo: the newest that is not undone."""

    change: int


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
