"""Schemas of the vision node's settings."""

from typing import Annotated

from pydantic import BaseModel, Field, FiniteFloat

from robot_runtime.contract.vision_settings import ColourRange, Share, VisionSettings
from server.http.request_body import RequestBody

TEXT_MAX = 20_000


class VisionSetup(BaseModel):
    """The settings now, and those of robot.toml."""

    settings: VisionSettings
    configured: VisionSettings


class PickPlace(RequestBody):
    """A point of the picture that was clicked."""

    x: Annotated[Share, Field(description="share of the picture's width")]
    y: Annotated[Share, Field(description="share of its height")]
    radius: Annotated[
        FiniteFloat,
        Field(ge=0.005, le=0.2, description="of the circle that is examined, as a share of the width"),
    ] = 0.02


class PickedColour(BaseModel):
    """A colour range, and the share of the picture that lies in it."""

    colour: ColourRange
    share: float


class VisionText(RequestBody):
    """robot.toml, or a piece of it with the table [vision]."""

    text: Annotated[str, Field(max_length=TEXT_MAX)]
