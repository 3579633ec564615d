"""Figures: a value or the reason why there is none, and what the figure means."""

from typing import Literal

from pydantic import BaseModel, Field


class FigureMeaning(BaseModel):
    """Name, unit and definition of a figure."""

    name: str
    title: str
    unit: str
    decimals: int
    better: Literal["less", "zero", "neither"] = Field(
        description="the better value: the least, the nearest to 0"
    )
    meaning: str = Field(description="a sentence for who asks")


class FigureMark(BaseModel):
    """Where a figure is to be seen in the chart of the depth: s since the session's start, and m."""

    start: float
    end: float
    low: float | None = Field(default=None, description="null: as high as the chart")
    high: float | None = None


class Figure(BaseModel):
    """A figure's value, or why there is none."""

    value: float | None
    words: str = Field(default="", description="why there is no value, or what else is to be known")
    mark: FigureMark | None = None
