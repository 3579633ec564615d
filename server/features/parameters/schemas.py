"""Parameters, their changes and profiles as the interface shows them."""

from datetime import datetime
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, StrictBool, StrictInt, StringConstraints

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
    why: str = Field(description="“Profile NAME” where a profile was restored, else empty")
    values: list[ChangedValue]
    undone: str = Field(description="by whom; empty where it was not undone")
    undoable: bool = Field(description="whether it is the next that can be undone")


class Undo(BaseModel):
    """Which change is to be undone: the newest that is not undone."""

    model_config = ConfigDict(extra="forbid")
    change: int


class Profile(BaseModel):
    """Parameters that are kept under a name."""

    id: int
    name: str
    note: str
    saved: datetime = Field(description="UTC")
    values: dict[str, Value]


class NewProfile(BaseModel):
    """The parameters in force are to be kept under this name."""

    model_config = ConfigDict(extra="forbid")
    name: ProfileName
    note: ProfileNote = ""


class LeftOut(BaseModel):
    """A parameter that was not taken."""

    name: str
    why: str


class Restored(BaseModel):
    """Result of restoring a profile."""

    changed: list[ChangedValue]
    left_out: list[LeftOut]


class ProfileText(BaseModel):
    """A profile's file, as text."""

    model_config = ConfigDict(extra="forbid")
    text: Annotated[str, Field(max_length=200_000)]


class Imported(BaseModel):
    """A profile from a file, and those of its parameters that this robot does not know."""

    profile: Profile
    unknown: list[str]
