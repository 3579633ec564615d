"""Operations on the vision node: its settings, and the colour at a point in its picture."""

from dataclasses import fields
from typing import Any

import tomli_w
from fastapi.responses import PlainTextResponse

from robot_runtime.config import VisionConfig
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.parsing import parse, read_value
from robot_runtime.contract.problems import DocumentEntry
from robot_runtime.contract.toml_text import TomlError, read_toml
from robot_runtime.contract.vision_settings import VisionSettings
from server.driving.changes import COMMAND_ERRORS, Changes
from server.features.vision.schemas import PickedColour, PickPlace, VisionEdit, VisionSetup, VisionText
from server.http.dependencies import Provided
from server.http.heavy_requests import TooManyHeavyError, Turn
from server.http.operations import Operations
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import Need
from server.platform.edited_meanwhile import ChangedMeanwhileError
from server.stream.bridge import Bridge, RuntimeSilentError

router = Operations(prefix="/api/vision", tags=["vision"])


@router.operation("GET", Need.VIEWER, RuntimeSilentError, response_model=VisionSetup)
async def get_vision(bridge: Provided[Bridge]) -> object:
    """Return the vision settings now, and those of robot.toml."""
    answer = await bridge.query("vision")
    return {name: answer[name] for name in ("settings", "configured")}


@router.operation("PUT", Need.CONTROL, *COMMAND_ERRORS)
async def edit_vision(
    bridge: Provided[Bridge], changes: Provided[Changes], caller: Caller, edit: VisionEdit
) -> None:
    """Replace all vision settings, also for later starts, unless somebody has changed them meanwhile."""

    async def check() -> None:
        if edit.base is not None:
            present = parse(VisionSettings, (await bridge.query("vision"))["settings"])
            began = edit.base.replace(present)
            names = [field.name for field in fields(present)]
            differing = [name for name in names if getattr(present, name) != getattr(began, name)]
            if differing and present != edit.settings.replace(present):
                raise ChangedMeanwhileError(f"A vision setting ({', '.join(differing)})", "")

    await changes.command(caller.name, edit.settings, check=check)


@router.operation("POST /pick", Need.VIEWER, {409: "There is no colour, or no picture"}, RuntimeSilentError)
async def pick_colour(bridge: Provided[Bridge], point: PickPlace) -> PickedColour:
    """Return the colour range at a point in the newest picture, and its mask.

    Changes nothing.
    """
    answer = await bridge.query("pick", point.model_dump())
    return PickedColour.model_validate(answer, extra="ignore")


@router.operation("GET /toml", Need.VIEWER, RuntimeSilentError, response_class=PlainTextResponse, linked=True)
async def download_vision(bridge: Provided[Bridge]) -> PlainTextResponse:
    """Download the vision settings as the table [vision] of robot.toml."""
    answer = await bridge.query("vision")
    headers = {"Content-Disposition": 'attachment; filename="vision.toml"'}
    return PlainTextResponse(tomli_w.dumps({"vision": answer["settings"]}), headers=headers)


@router.operation(
    "POST /read", Need.VIEWER, TooManyHeavyError, {422: "There are no settings in it that can be used"}
)
def read_vision(_: Turn, document: VisionText) -> VisionSettings:
    """Read the vision settings in a robot.toml.

    Changes nothing.
    """
    return parse(VisionSettings, read_document(document.text))


def read_document(text: str) -> dict[str, Any]:
    """Return the settings of the table [vision] in robot.toml, in the form of `VisionSettings.table`.

    Settings that are not named have their defaults. Raise ConfigError if there is no such table, or if it is
    not valid.
    """
    try:
        document = read_toml(text)
    except TomlError as problem:
        raise ConfigError(f"This {problem}.") from problem
    if "vision" not in document:
        raise ConfigError("There is no table [vision] in it.")
    # A whole robot.toml also names the camera, which cannot be changed while the robot runs.
    config: VisionConfig = read_value(VisionConfig, document["vision"], DocumentEntry("vision", ("vision",)))
    return config.settings.table()
