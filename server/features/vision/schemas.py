"""Schemas of the vision node's settings."""

from typing import TYPE_CHECKING, Annotated

from pydantic import ConfigDict, Field, FiniteFloat

from robot_runtime.contract.vision_settings import ColourRange, Share, VisionSettings
from server.http.request_body import RequestBody
from server.platform.schema_base import Schema

if TYPE_CHECKING:
    # The command is made of fields at its definition, which no type checker sees.
    from robot_runtime.contract.commands import VisionSettingsBase as VisionSettingsCommand
else:
    from robot_runtime.contract.commands import VisionSettingsCommand

TEXT_MAX = 20_000


class VisionSetup(Schema):
    """The settings now, and those of robot.toml."""

    settings: VisionSettings
    configured: VisionSettings


class VisionEdit(RequestBody):
    """All settings, and those at the beginning of the editing."""

    # The numbers within are strict of themselves; a dataclass is read from JSON only where the whole is not.
    model_config = ConfigDict(strict=False)

    settings: VisionSettingsCommand
    base: VisionSettingsCommand | None = Field(
        default=None, description="refused if others are in force by now; null replaces any"
    )


class PickPlace(RequestBody):
    """A point of the picture that was clicked."""

    x: Annotated[Share, Field(description="share of the picture's width")]
    y: Annotated[Share, Field(description="share of its height")]
    radius: Annotated[
        FiniteFloat,
        Field(ge=0.005, le=0.2, description="of the circle that is examined, as a share of the width"),
    ] = 0.02


class PickedColour(Schema):
    """A colour range, the share of the picture within it, and the mask that it would have."""

    colour: ColourRange
    share: float
    mask: Annotated[str, Field(description="a JPEG file, in base64")]


class VisionText(RequestBody):
    """robot.toml, or a piece of it with the table [vision]."""

    text: Annotated[str, Field(max_length=TEXT_MAX)]
