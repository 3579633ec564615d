"""Figures: a value or the reason for its lack, and the meaning of a figure."""

from typing import Literal

from pydantic import Field

from server.platform.schema_base import Schema

Better = Literal["less", "zero", "neither"]


class FigureMeaning(Schema):
    """Name, unit and definition of a figure."""

    name: str
    title: str
    unit: str
    decimals: int
    better: Better = Field(description="the better value: the least, the nearest to 0")
    meaning: str = Field(description="its definition in a sentence")


def describe(
    name: str, title: str, unit: str, decimals: int, meaning: str, better: Better = "less"
) -> FigureMeaning:
    """Return the meaning of a figure; by default less is better."""
    return FigureMeaning(name=name, title=title, unit=unit, decimals=decimals, better=better, meaning=meaning)


class FigureMark(Schema):
    """The position of a figure in its chart: s since the session's start or the step, and m or degrees."""

    start: float
    end: float
    low: float | None = Field(default=None, description="null: as high as the chart")
    high: float | None = None


class Figure(Schema):
    """A figure's value, or the reason for its lack."""

    value: float | None
    words: str = Field(default="", description="the reason for a missing value, or a remark")
    mark: FigureMark | None = None
