"""Figures as an archive keeps them."""

from pydantic import Field

from server.platform.schema_base import Schema


class FigureSet(Schema):
    """The figures of one session (`segment` 0), or of one of its segments, from 1 on."""

    segment: int
    controller: str = Field(description="title; empty where no depth was held")
    gains: str = Field(description="such as “kd 2, ki 0.4, kp 3”; empty without")
    craft: str
    values: dict[str, float] = Field(description="by the names of STORY_FIGURES; those that are known")
