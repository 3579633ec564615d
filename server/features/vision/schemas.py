"""What the interface says about the vision node's settings."""

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, StrictInt

from robot_runtime.contract.vision_settings import (
    BYTE_MAX,
    COLOURS_MAX,
    HUE_MAX,
    MARKERS_MAX,
    MarkerDictionary,
    WhiteBalance,
)

TEXT_MAX = 20_000

Name = Annotated[str, Field(min_length=1, max_length=32)]
Hue = Annotated[StrictInt, Field(ge=0, le=HUE_MAX)]
Byte = Annotated[StrictInt, Field(ge=0, le=BYTE_MAX)]
Share = Annotated[FiniteFloat, Field(ge=0, le=1)]
Area = Annotated[FiniteFloat, Field(ge=0.0001, le=1, description="share of the picture")]
Aspect = Annotated[FiniteFloat, Field(ge=0.05, le=20)]
Metres = Annotated[FiniteFloat, Field(ge=0, le=10)]


class ColourRange(BaseModel):
    """Lowest and highest hue, saturation and value, as OpenCV counts them; hues may run through 0."""

    model_config = ConfigDict(extra="forbid")
    hue: tuple[Hue, Hue]
    saturation: tuple[Byte, Byte]
    value: tuple[Byte, Byte]


class VisionSettings(BaseModel):
    """How the vision node looks, all of it; docs/use/vision.md explains each."""

    model_config = ConfigDict(extra="forbid")
    rate: Annotated[FiniteFloat, Field(ge=2, le=30, description="Hz")]
    colour: Annotated[Name, Field(description="the wanted one, of the colours")]
    colours: Annotated[dict[Name, ColourRange], Field(min_length=1, max_length=COLOURS_MAX)]
    area_min: Area
    area_max: Area
    fill_min: Annotated[Share, Field(description="least area over that of the upright box")]
    aspect: Annotated[tuple[Aspect, Aspect], Field(description="width over height")]
    circularity_min: Annotated[Share, Field(description="least 4π area over perimeter²")]
    opening: Annotated[FiniteFloat, Field(ge=0, le=0.1, description="share of the picture's width")]
    white_balance: WhiteBalance
    markers: Annotated[MarkerDictionary, Field(description="dictionary of ArUco markers")]
    marker_numbers: Annotated[
        list[Annotated[StrictInt, Field(ge=0, le=1023)]],
        Field(max_length=MARKERS_MAX, description="those that count; empty: all"),
    ]
    actions: Annotated[
        dict[Name, Metres],
        Field(max_length=COLOURS_MAX + MARKERS_MAX, description="m, by colour or “marker 7”; the first goes"),
    ]


class VisionInForce(BaseModel):
    """The settings now, and those of robot.toml."""

    settings: VisionSettings
    configured: VisionSettings


class PickPlace(BaseModel):
    """Where somebody points in the picture."""

    model_config = ConfigDict(extra="forbid")
    x: Annotated[Share, Field(description="share of the picture's width")]
    y: Annotated[Share, Field(description="share of its height")]
    radius: Annotated[
        FiniteFloat, Field(ge=0.005, le=0.2, description="share of its width; what is nearer counts")
    ] = 0.02


class PickedColour(BaseModel):
    """The range that was found, and how much of the picture it holds."""

    colour: ColourRange
    share: float


class VisionText(BaseModel):
    """robot.toml, or a piece of it with the table [vision]."""

    model_config = ConfigDict(extra="forbid")
    text: Annotated[str, Field(max_length=TEXT_MAX)]


def as_model(table: dict[str, Any]) -> VisionSettings:
    """Settings as the runtime says them."""
    return VisionSettings.model_validate(table)
