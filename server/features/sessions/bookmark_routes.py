"""Marks: moments of a session that people point out."""

from typing import Annotated

from fastapi import APIRouter, Path
from pydantic import BaseModel, ConfigDict, Field, StringConstraints

from server.features.sessions.bookmarks import Markers
from server.features.sessions.catalogue import Catalogue
from server.features.sessions.dependencies import STORING, Identifier
from server.features.sessions.session import Mark
from server.http.dependencies import Provided
from server.http.problems import answers
from server.http.sign_in.policy import Need, needs
from server.platform.models import IDENTIFIER_MAX

UNKNOWN = answers(_404="There is no such session, or it has no such mark")

router = APIRouter(prefix="/api/sessions/{session}/markers", tags=["sessions"])

MarkIdentifier = Annotated[int, Path(ge=1, le=IDENTIFIER_MAX)]
Text = Annotated[str, StringConstraints(strip_whitespace=True, max_length=500)]
Moment = Annotated[float, Field(ge=0, allow_inf_nan=False)]


class NewMark(BaseModel):
    """A moment to be marked: s since the session's start, or null for now."""

    model_config = ConfigDict(extra="forbid")
    time: Moment | None = None
    text: Text = ""


class MarkChanges(BaseModel):
    """What is to be different; what is left out stays as it is."""

    model_config = ConfigDict(extra="forbid")
    time: Moment | None = None
    text: Text | None = None


@router.post(
    "",
    status_code=201,
    summary="Mark a moment",
    operation_id="addMark",
    openapi_extra=needs(Need.OPERATOR),
    responses={**UNKNOWN, **STORING},
)
async def add_mark(
    markers: Provided[Markers], catalogue: Provided[Catalogue], session: Identifier, wanted: NewMark
) -> Mark:
    """Mark a moment, now or later; refused beyond the session's end, and without a time once it has ended."""
    mark = await markers.add(session, wanted.time, wanted.text)
    catalogue.tell(session)
    return mark


@router.patch(
    "/{mark}",
    summary="Change a mark",
    operation_id="changeMark",
    openapi_extra=needs(Need.OPERATOR),
    responses={**UNKNOWN, **STORING},
)
async def change_mark(
    markers: Provided[Markers], session: Identifier, mark: MarkIdentifier, wanted: MarkChanges
) -> Mark:
    """Move it, or say something else of it."""
    return await markers.change(session, mark, wanted.time, wanted.text)


@router.delete(
    "/{mark}",
    status_code=204,
    summary="Take a mark away",
    operation_id="removeMark",
    openapi_extra=needs(Need.OPERATOR),
    responses={**UNKNOWN, **STORING},
)
async def remove_mark(
    markers: Provided[Markers], catalogue: Provided[Catalogue], session: Identifier, mark: MarkIdentifier
) -> None:
    """Take it away for good."""
    await markers.remove(session, mark)
    catalogue.tell(session)
