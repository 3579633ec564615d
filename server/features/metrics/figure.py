"""Figures: a value or the reason why there is none, and what the figure means."""

from typing import Literal

from pydantic import BaseModel, Field

Better = Literal["less", "zero", "neither"]


class FigureMeaning(BaseModel):
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
    """The meaning of a figure, of which less is better unless `better` says otherwise."""
    return FigureMeaning(name=name, title=title, unit=unit, decimals=decimals, better=better, meaning=meaning)


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
