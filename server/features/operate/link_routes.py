"""The serial line: the last frames each way, for whoever looks for what has gone wrong."""

from fastapi import APIRouter
from pydantic import BaseModel, Field

from server.http.dependencies import Provided
from server.http.problems import answers
from server.http.sign_in.policy import Need, needs
from server.stream.bridge import Bridge

router = APIRouter(prefix="/api/link", tags=["link"])


class LinkFrame(BaseModel):
    """One frame; where `problem` is not empty it was thrown away, and what it seems to hold is a guess."""

    time: float = Field(description="s, steady clock: handed to the line, or taken from it")
    sent: bool = Field(description="to the board; else from it")
    bytes: str = Field(description="as on the line with the closing zero, hexadecimal")
    kinds: list[str] = Field(description="names of its messages")
    reliable: bool = Field(description="repeated until it is acknowledged")
    open: bool = Field(description="belongs to no session")
    number: int | None = Field(description="its own, of 16 reliable or 4096 unreliable ones")
    acknowledged: int | None = Field(description="the reliable frame that its sender waits for")
    problem: str = Field(description="why it was thrown away; empty where it was valid")


class LinkFault(BaseModel):
    """The last time that something went wrong on the line, and the frames until then."""

    time: float = Field(description="s, steady clock")
    text: str
    frames: list[LinkFrame]


class LinkFrames(BaseModel):
    """The last hundred frames each way since the port was opened, in the order of time."""

    time: float = Field(description="now, s, steady clock")
    frames: list[LinkFrame]
    fault: LinkFault | None = Field(description="null where there was none since the runtime started")


@router.get(
    "/frames",
    summary="The last frames on the serial line, now and at the last fault",
    operation_id="getLinkFrames",
    openapi_extra=needs(Need.VIEWER),
    responses=answers(_503="The runtime is not running", _504="The runtime did not answer within 2 s"),
)
async def get_frames(bridge: Provided[Bridge]) -> LinkFrames:
    """Asked of the runtime at each call; it costs nothing where nobody calls."""
    return LinkFrames.model_validate(await bridge.query("frames"))
