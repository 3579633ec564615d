"""Schemas of people and programs that sign in."""

from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from server.http.sign_in.identity import Identity, Kind, Role

NAME_LENGTH_MAX = 40


def _check_name(name: str) -> str:
    name = " ".join(name.split())
    if not name or not name.isprintable():
        raise ValueError("must have letters that can be seen, and no control characters")
    return name


Name = Annotated[str, Field(max_length=NAME_LENGTH_MAX), AfterValidator(_check_name)]


class Me(BaseModel):
    """The signed-in caller; `pairing_open` says that some pairing code is valid now."""

    signed_in: bool
    robot: str
    identity: Identity | None
    pairing_open: bool
    operators_only: list[str] = Field(description="operations that viewers are refused, by their names")


class Pairing(BaseModel):
    """A code, and what this browser is to be called."""

    model_config = ConfigDict(extra="forbid")
    code: Annotated[str, Field(min_length=1, max_length=64)]
    name: Name


class NewCode(BaseModel):
    """A code that is to be made."""

    model_config = ConfigDict(extra="forbid")
    role: Role = "viewer"


class MadeCode(BaseModel):
    """A code for one pairing; `expires` in s since 1970, `qr_svg` is a picture of the link."""

    code: str
    link: str
    role: Role
    expires: float
    qr_svg: str


class DeviceDetails(BaseModel):
    """A browser or a program that may come in; times in s since 1970."""

    id: int
    name: str
    role: Role
    kind: Kind
    paired: float
    seen: float
    you: Annotated[bool, Field(description="whether it is what asks")]


class DeviceChanges(BaseModel):
    """Changes of a device; null leaves a field unchanged."""

    model_config = ConfigDict(extra="forbid")
    name: Name | None = None
    role: Role | None = None


class NewToken(BaseModel):
    """A program that is to be let in."""

    model_config = ConfigDict(extra="forbid")
    name: Name
    role: Role = "viewer"


class MadeToken(BaseModel):
    """A program's token, which is shown this once."""

    token: str
    device: DeviceDetails
