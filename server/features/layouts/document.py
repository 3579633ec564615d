"""A layout of panels as a document, the same in the database, in files and in the page (layout/layout.ts)."""

from itertools import combinations
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from server.http.request_body import RequestBody

VERSION = 1
COLUMNS = 24
ROWS_MOST = 96
PANELS_MOST = 40
SIGNALS_MOST = 12

PanelName = Annotated[str, Field(pattern=r"^(own/)?[A-Za-z0-9][A-Za-z0-9 _-]{0,59}$")]
Word = Annotated[str, Field(min_length=1, max_length=60)]


def _check_distinct(signals: list[str]) -> list[str]:
    if len(set(signals)) < len(signals):
        raise _wrong("A chart names a signal twice.")
    return signals


class ShownChart(RequestBody):
    """A chart's signals, by the names in recordings (`motor.angle_2`), and its length in s."""

    signals: Annotated[list[Word], Field(max_length=SIGNALS_MOST), AfterValidator(_check_distinct)]
    seconds: Annotated[float, Field(ge=1, le=3600, allow_inf_nan=False)]


class PlacedPanel(RequestBody):
    """A panel, and its position in columns and rows of the grid from the upper left corner."""

    id: Word
    panel: PanelName
    x: Annotated[int, Field(ge=0, lt=COLUMNS)]
    y: Annotated[int, Field(ge=0, lt=ROWS_MOST)]
    width: Annotated[int, Field(ge=1, le=COLUMNS)]
    height: Annotated[int, Field(ge=1, le=ROWS_MOST)]
    chart: ShownChart | None = None

    def overlaps(self, other: "PlacedPanel") -> bool:
        """Return True where both panels cover a common cell."""
        return (
            self.x < other.x + other.width
            and other.x < self.x + self.width
            and self.y < other.y + other.height
            and other.y < self.y + self.height
        )


class LayoutDocument(RequestBody):
    """The positions of the panels of Operate."""

    format: Literal["mucat-layout"]
    version: int
    panels: Annotated[list[PlacedPanel], Field(max_length=PANELS_MOST)]

    @model_validator(mode="before")
    @classmethod
    def _know_the_version(cls, document: Any) -> Any:
        # First of all: the panels of another version may have another form.
        if isinstance(document, dict) and document.get("format") == "mucat-layout":
            version = document.get("version")
            if version != VERSION or isinstance(version, bool):
                named = "names no version" if version is None else f"is of version {str(version)[:20]}"
                raise _wrong(
                    f"This layout {named}; this program reads version {VERSION}. "
                    "Arrange the panels again, and save them."
                )
        return document

    @model_validator(mode="after")
    def _stand_apart(self) -> Self:
        if len({panel.id for panel in self.panels}) < len(self.panels):
            raise _wrong("Two of its panels have the same id.")
        for panel in self.panels:
            if panel.x + panel.width > COLUMNS or panel.y + panel.height > ROWS_MOST:
                raise _wrong(f"{panel.panel} does not fit into {COLUMNS} columns and {ROWS_MOST} rows.")
        for panel, other in combinations(self.panels, 2):
            if panel.overlaps(other):
                raise _wrong(f"{panel.panel} and {other.panel} lie over each other.")
        return self


def _wrong(text: str) -> PydanticCustomError:
    # A text of pydantic's own is a template, in which braces mean something.
    return PydanticCustomError("layout", "{words}", {"words": text})
