"""The serial line: the last frames each way, for diagnosis."""

from fastapi import APIRouter
from pydantic import BaseModel, Field

from robot_runtime.link.dissection import Dissection
from server.http.dependencies import Provided
from server.http.operation import Operation
from server.http.problems import answers
from server.http.sign_in.policy import Need, needs
from server.stream.bridge import Bridge

router = APIRouter(prefix="/api/link", tags=["link"], route_class=Operation)


class LinkFault(BaseModel):
    """The last time that something went wrong on the line, and the frames until then."""

    time: float = Field(description="s, steady clock")
    text: str
    frames: list[Dissection]


class LinkFrames(BaseModel):
    """The last hundred frames each way since the port was opened, in the order of time."""

    time: float = Field(description="now, s, steady clock")
    frames: list[Dissection]
    fault: LinkFault | None = Field(description="null where there was none since the runtime started")


@router.get(
    "/frames",
    openapi_extra=needs(Need.VIEWER),
    responses=answers(_503="The runtime is not running", _504="The runtime did not answer within 2 s"),
)
async def get_link_frames(bridge: Provided[Bridge]) -> LinkFrames:
    """Return the last frames on the serial line, now and at the last fault.

    Each call asks the runtime; without calls it costs nothing.
    """
    return LinkFrames.model_validate(await bridge.query("frames"))
