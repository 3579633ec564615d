"""The vision node's settings, and the colour at a place in its picture."""

from fastapi import APIRouter
from fastapi.responses import PlainTextResponse

from robot_runtime.contract.parsing import parse
from robot_runtime.contract.vision_settings import VisionSettings
from server.features.vision.schemas import PickedColour, PickPlace, VisionSetup, VisionText
from server.features.vision.toml_document import read_document, write_document
from server.http.dependencies import Provided
from server.http.problems import SILENT, answers
from server.http.sign_in.policy import Need, needs
from server.stream.bridge import Bridge

router = APIRouter(prefix="/api/vision", tags=["vision"])


@router.get(
    "",
    summary="How the vision node looks",
    operation_id="getVision",
    openapi_extra=needs(Need.VIEWER),
    responses=SILENT,
    response_model=VisionSetup,
)
async def get_vision(bridge: Provided[Bridge]) -> object:
    """All settings that may change while it looks, and what robot.toml says of them."""
    answer = await bridge.query("vision")
    return {name: answer[name] for name in ("settings", "configured")}


@router.post(
    "/pick",
    summary="The colour at a place in the picture",
    operation_id="pickColour",
    openapi_extra=needs(Need.VIEWER),
    responses={**answers(_409="There is no colour, or no picture"), **SILENT},
)
async def pick(bridge: Provided[Bridge], place: PickPlace) -> PickedColour:
    """A range for what is there in the newest picture. It changes nothing."""
    answer = await bridge.query("pick", place.model_dump())
    return PickedColour.model_validate(answer, extra="ignore")


@router.get(
    "/toml",
    summary="The settings as a part of robot.toml",
    operation_id="downloadVision",
    openapi_extra=needs(Need.VIEWER),
    response_class=PlainTextResponse,
    responses=SILENT,
)
async def download(bridge: Provided[Bridge]) -> PlainTextResponse:
    """The table [vision], to be kept or to be put into robot.toml."""
    answer = await bridge.query("vision")
    return PlainTextResponse(
        write_document(answer["settings"]),
        headers={"Content-Disposition": 'attachment; filename="vision.toml"'},
    )


@router.post(
    "/read",
    summary="Read the settings in a robot.toml",
    operation_id="readVision",
    openapi_extra=needs(Need.VIEWER),
    responses=answers(_422="There are no settings in it that can be used"),
)
def read(document: VisionText) -> VisionSettings:
    """The settings of the document's table [vision]. Changes nothing."""
    return parse(VisionSettings, read_document(document.text))
