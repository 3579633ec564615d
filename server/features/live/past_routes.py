"""The rows of the last minutes, for a page that is new or was disconnected."""

from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import Query
from fastapi.responses import Response, StreamingResponse
from pydantic import StringConstraints

from robot_runtime.contract.topics import TOPICS, Kind
from server.http.dependencies import Provided
from server.http.operations import Operations
from server.http.sign_in.policy import Need
from server.stream.hub import Hub

PIECE_BYTES = 65_536

router = Operations()

_ROWS = "|".join(topic.name for topic in TOPICS if topic.kind is Kind.ROWS)
RowTopic = Annotated[str, StringConstraints(pattern=f"^({_ROWS})$")]


@router.operation("GET /api/past", Need.VIEWER, media_type="application/octet-stream", tags=["live"])
async def get_past(
    hub: Provided[Hub],
    topic: Annotated[list[RowTopic], Query(min_length=1, description="of rows; may be given several times")],
    until: Annotated[
        float, Query(allow_inf_nan=False, description="s, steady clock; a little more may come")
    ],
) -> Response:
    """Return rows of the last ten minutes.

    All rows of these topics up to `until`, topic by topic, oldest first, as blocks.
    """
    rows = hub.history.rows(topic, until)
    headers = {"Cache-Control": "no-store", "Content-Length": str(sum(map(len, rows)))}
    return StreamingResponse(_gather(rows), media_type="application/octet-stream", headers=headers)


async def _gather(chunks: list[bytes]) -> AsyncIterator[bytes]:
    """Yield the chunks in pieces of about `PIECE_BYTES`, each made when the client has read the last."""
    first = size = 0
    for index, chunk in enumerate(chunks):
        size += len(chunk)
        if size >= PIECE_BYTES or index == len(chunks) - 1:
            yield b"".join(chunks[first : index + 1])
            first, size = index + 1, 0
