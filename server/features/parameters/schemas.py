"""Schemas of parameters, their changes and profiles."""

from datetime import datetime
from typing import Annotated

from pydantic import BaseModel, Field, FiniteFloat, StrictBool, StrictInt, StringConstraints

from server.http.request_body import RequestBody

PARAMETERS_MAX = 1000

ParameterName = Annotated[str, StringConstraints(min_length=1, max_length=100)]
Number = Annotated[FiniteFloat, Field(strict=True)]
Text = Annotated[str, Field(max_length=100)]
Value = StrictBool | StrictInt | Number | Text
Values = Annotated[dict[ParameterName, Value], Field(max_length=PARAMETERS_MAX)]
ProfileName = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=100)]
ProfileNote = Annotated[str, StringConstraints(strip_whitespace=True, max_length=1000)]


class ChangedValue(BaseModel):
    """One parameter before and after a change."""

    name: str
    before: Value
    after: Value


class Change(BaseModel):
    """Parameters that were changed together."""

    id: int
    time: datetime = Field(description="UTC")
    who: str
    why: str = Field(description="“Profile NAME” for a restored profile, else empty")
    values: list[ChangedValue]
    undone: str = Field(description="the person who undid it; empty if it was not undone")
    undoable: bool = Field(description="true for the next change that can be undone")


class Undo(RequestBody):
    """The change to undo: the newest that is not undone."""

    change: int


class Profile(BaseModel):
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


class LeftOut(BaseModel):
    """A parameter that was not set, and the reason."""

    name: str
    why: str


class Restored(BaseModel):
    """The parameters that a command changed, and those that it left out."""

    changed: list[ChangedValue]
    left_out: list[LeftOut]


class ProfileText(RequestBody):
    """A profile's file, as text."""

    text: Annotated[str, Field(max_length=200_000)]


class Imported(BaseModel):
    """An imported profile, and its parameters that this robot does not know."""

    profile: Profile
    unknown: list[str]
