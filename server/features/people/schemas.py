"""Schemas of browsers and programs, and of pairing."""

from typing import Annotated

from pydantic import AfterValidator, Field

from server.http.request_body import RequestBody
from server.http.sign_in.identity import Identity, Kind, Role, Scope
from server.http.sign_in.names import NAME_LENGTH_MAX, clean_name
from server.platform.schema_base import Schema

TOKEN_DAYS, TOKEN_DAYS_MAX = 90, 3650


Name = Annotated[str, Field(max_length=NAME_LENGTH_MAX), AfterValidator(clean_name)]


class CallerDetails(Schema):
    """The caller, and the robot; `pairing_open` is true while a pairing code is valid."""

    signed_in: bool
    robot: str
    lab: bool = Field(description="true where this server is a lab's, which has no robot")
    identity: Identity | None
    ended: Annotated[str, Field(description="why the sign-in that was shown counts no longer; else empty")]
    pairing_open: bool
    operators_only: list[str] = Field(
        description="names of the operations that the caller's role may not call; a reader's are all that do "
        "not read the session of the link"
    )
    ends: float | None = Field(description="end of the caller's token or reading link, s since 1970")


class Paired(CallerDetails):
    """The caller after pairing."""

    page_secret: Annotated[
        str | None, Field(description="shown only this once; null where the browser was signed in already")
    ]


class Pairing(RequestBody):
    """A code, and a name for this browser."""

    code: Annotated[str, Field(min_length=1, max_length=64)]
    name: Name


class Confirmation(RequestBody):
    """A code that confirms the user of this browser."""

    code: Annotated[str, Field(min_length=1, max_length=64)]


class NewCode(RequestBody):
    """A pairing code to be made."""

    role: Role = "viewer"


class MadeCode(Schema):
    """A code for one pairing; `expires` in s since 1970, `qr_svg` is a picture of the link.

    `other_links` do the same at the server's other addresses; `only_here`: no other computer reaches any.
    """

    code: str
    link: str
    other_links: list[str]
    only_here: bool
    role: Role
    expires: float
    qr_svg: str


class DeviceDetails(Schema):
    """A paired browser or program; times in s since 1970."""

    id: int
    name: str
    role: Role
    kind: Kind
    paired: float
    seen: float
    limited: Annotated[bool, Field(description="true for a token that may not administer, in any role")]
    ends: Annotated[float | None, Field(description="end of a token; null where it never ends")]
    ended: Annotated[
        str, Field(description="why the token, or an unused sign-in, counts no longer; else empty")
    ]
    you: Annotated[bool, Field(description="true for the caller itself")]


class DeviceChanges(RequestBody):
    """Changes of a device; null leaves a field unchanged."""

    name: Name | None = None
    role: Role | None = None


class NewToken(RequestBody):
    """A program that gets a token."""

    name: Name
    scope: Scope = "read"
    days: Annotated[
        int | None, Field(ge=1, le=TOKEN_DAYS_MAX, description="until it ends; null: it never ends")
    ] = TOKEN_DAYS


class MadeToken(Schema):
    """A program's token, shown only this once."""

    token: str
    device: DeviceDetails
