"""Bookmarks of a session."""

from server.http.dependencies import Provided
from server.http.operations import Identifier, Operations
from server.http.sign_in.policy import Need
from server.library.bookmarks import Bookmarks
from server.library.catalogue import Catalogue
from server.library.schemas import (
    Bookmark,
    BookmarkChanges,
    NewBookmark,
)
from server.platform.errors import ConflictError

router = Operations(prefix="/api", tags=["sessions"])

NO_BOOKMARK = {404: "There is no such session, or it has no such bookmark"}


@router.operation(
    "POST /sessions/{session}/markers", Need.OPERATOR, NO_BOOKMARK, ConflictError, status_code=201
)
async def add_mark(
    bookmarks: Provided[Bookmarks], catalogue: Provided[Catalogue], session: Identifier, body: NewBookmark
) -> Bookmark:
    """Bookmark a moment, with a note if one is given; without a time it is now.

    Refused beyond the session's end, and without a time after the session has ended.
    """
    mark = await bookmarks.add(session, body.time, body.text)
    catalogue.notify(session)
    return mark


@router.operation("PATCH /sessions/{session}/markers/{mark}", Need.OPERATOR, NO_BOOKMARK, ConflictError)
async def change_mark(
    bookmarks: Provided[Bookmarks], session: Identifier, mark: Identifier, body: BookmarkChanges
) -> Bookmark:
    """Change the time or the note of a bookmark."""
    return await bookmarks.change(session, mark, body.time, body.text, body.base)


@router.operation("DELETE /sessions/{session}/markers/{mark}", Need.OPERATOR, NO_BOOKMARK, ConflictError)
async def remove_mark(
    bookmarks: Provided[Bookmarks], catalogue: Provided[Catalogue], session: Identifier, mark: Identifier
) -> None:
    """Remove a bookmark for good."""
    await bookmarks.remove(session, mark)
    catalogue.notify(session)
