"""Operations on reading links: each lets anybody read one session until it ends, without a sign-in."""

import time
from typing import Annotated

from fastapi import Query, Request, Response
from pydantic import Field

from server.features.people.routes import describe_caller, set_cookie
from server.features.people.schemas import Paired
from server.http.dependencies import Provided
from server.http.operations import Identifier, Operations
from server.http.request_body import RequestBody
from server.http.sign_in.access import Access, LinkEndedError
from server.http.sign_in.devices import DAY_SECONDS, Device, UnknownLinkError
from server.http.sign_in.identity import IDENTITY, Caller
from server.http.sign_in.policy import Need
from server.platform.schema_base import Schema
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.schemas import SessionNumber
from server.recording.session import UnknownSessionError, find_row

DAYS_MAX = 366
NOT_MADE = {409: "The end is over, too many links, or the clock is not set"}

router = Operations(prefix="/api/access", tags=["access"])


class NewReadingLink(RequestBody):
    """A session, and the end of the link (s since 1970)."""

    session: SessionNumber
    ends: Annotated[float, Field(ge=0, le=1e11, allow_inf_nan=False)]


class ReadingLink(Schema):
    """A reading link; times in s since 1970. `used` is null where nobody has opened it."""

    id: int
    session: int
    made: float
    ends: float
    used: float | None
    ended: Annotated[str, Field(description="why it lets nobody in any more; else empty")]


class MadeReadingLink(Schema):
    """A reading link with its token, which is shown only this once."""

    token: str
    link: ReadingLink


class ReadingToken(RequestBody):
    """The token of a reading link."""

    token: Annotated[str, Field(min_length=1, max_length=200)]


@router.operation("POST /reading-links", Need.OPERATOR, UnknownSessionError, NOT_MADE, status_code=201)
async def make_reading_link(
    store: Provided[Store], access: Provided[Access], caller: Caller, body: NewReadingLink
) -> MadeReadingLink:
    """Make a reading link for a session.

    Whoever has it reads that session, and nothing else, until it ends, within a year. The page's address of
    the session carries the token after the hash, as `?read=…`, where no server and no log sees it. It is
    shown only this once.
    """
    find_row(store, body.session)
    ends = min(body.ends, time.time() + DAYS_MAX * DAY_SECONDS)
    link, token = await access.make_link(body.session, ends, caller)
    return MadeReadingLink(token=token, link=_describe(access, link))


@router.operation("GET /reading-links", Need.OPERATOR)
async def list_reading_links(
    access: Provided[Access], session: Annotated[SessionNumber, Query()]
) -> list[ReadingLink]:
    """List the reading links of a session, oldest first, with those that have ended by themselves."""
    return [_describe(access, link) for link in access.devices.links(session)]


@router.operation("DELETE /reading-links/{link}", Need.OPERATOR, UnknownLinkError)
async def end_reading_link(access: Provided[Access], caller: Caller, link: Identifier) -> None:
    """End a reading link.

    It ends at once, and for everybody who reads by it.
    """
    await access.end_link(link, caller)


@router.operation("POST /read", Need.NOTHING, LinkEndedError)
async def open_reading_link(
    request: Request,
    settings: Provided[Settings],
    access: Provided[Access],
    response: Response,
    body: ReadingToken,
) -> Paired:
    """Open a reading link in this browser.

    Sets a cookie, and answers the page's own secret, as for a browser that signs in. One that is signed in
    keeps its sign-in.
    """
    caller = request.scope[IDENTITY]
    if caller is not None and caller.session is None:
        return Paired(page_secret=None, **dict(describe_caller(request, settings, access, caller)))
    link, secrets = access.read_link(body.token)
    request.scope[IDENTITY] = link.identity
    seconds = int(access.devices.count_seconds(link.id) or 0)
    set_cookie(request, access, response, secrets.cookie, seconds)
    reader = describe_caller(request, settings, access, link.identity)
    return Paired(page_secret=secrets.page, **dict(reader))


def _describe(access: Access, link: Device) -> ReadingLink:
    assert link.session is not None
    assert link.ends is not None
    return ReadingLink(
        id=link.id,
        session=link.session,
        made=link.paired,
        ends=link.ends,
        used=None if link.seen <= link.paired else link.seen,
        ended=access.devices.explain_end(link) or "",
    )
