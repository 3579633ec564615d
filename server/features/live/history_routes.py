"""The minutes before a page was opened, for the charts that show them."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import Response
from pydantic import StringConstraints

from robot_runtime.contract.topics import TOPICS, Kind
from server.container import Assembly

router = APIRouter(prefix="/api/past", tags=["live"])

_ROWS = "|".join(topic.name for topic in TOPICS if topic.kind is Kind.ROWS)
RowTopic = Annotated[str, StringConstraints(pattern=f"^({_ROWS})$")]


@router.get(
    "",
    summary="The last ten minutes of some topics",
    operation_id="getPast",
    response_class=Response,
    responses={
        200: {"content": {"application/octet-stream": {}}, "description": "Blocks, as on the live socket"}
    },
)
async def get_past(
    request: Request,
    topic: Annotated[list[RowTopic], Query(min_length=1, description="of rows; may be given several times")],
    until: Annotated[
        float, Query(allow_inf_nan=False, description="s, steady clock; a little more may come")
    ],
) -> Response:
    """All rows that the server still has of these topics, up to `until`: topic by topic, the oldest first."""
    rows = Assembly.of(request).hub.history.rows(topic, until)
    return Response(rows, media_type="application/octet-stream", headers={"Cache-Control": "no-store"})
