"""The crafts of a session, as the simulator has sent them."""

import re
from collections.abc import Mapping, Sequence
from itertools import islice
from typing import Any, Literal

import tomli_w
from pydantic import Field

from robot_runtime.contract.craft import ORIGIN_MAX, TITLE_MAX
from robot_runtime.contract.topics import CRAFT, STATUS, TRUTH
from server.library.content import Recording, reading_content
from server.platform.schema_base import Schema

_LIST = re.compile(r"\[\n([^\[\]]*),\n\s*\]")
CRAFTS_MAX = 100
"""Crafts that are described, the first of a session: a simulator gets another by hand."""
Water = Literal["simulated", "real", "unknown"]


class RecordedCraft(Schema):
    """A craft that the simulator swam from `time` on."""

    time: float = Field(description="s since the session's start")
    title: str
    origin: str
    file: str = Field(description="the craft file, with all its numbers")


def read_crafts(recording: Recording) -> list[RecordedCraft]:
    """Return the crafts in the order of time; recordings of older versions have none.

    Raise StoreError, RecordingError.
    """
    if CRAFT.name not in recording.topics:
        return []
    with reading_content(recording.row):
        return [
            RecordedCraft(
                time=document["time"] - recording.row.started_steady,
                title=str(document["title"]),
                origin=str(document["origin"]),
                file=_file(document),
            )
            for document in islice(recording.changes(CRAFT.name), CRAFTS_MAX)
        ]


def which_water(topics: set[str]) -> Water:
    """Return the water of a session with samples of these topics: simulated only with a simulator's."""
    if topics & {CRAFT.name, TRUTH.name}:
        return "simulated"
    return "real" if STATUS.name in topics else "unknown"


def describe_crafts(water: Water, crafts: Sequence[RecordedCraft]) -> str:
    """Return the crafts' titles, or the reason why there is none; empty where unknown."""
    if crafts:
        return ", then ".join(craft.title for craft in crafts)
    return {"real": "real robot", "simulated": "not recorded", "unknown": ""}[water]


def _file(document: Mapping[str, Any]) -> str:
    origin = {"origin": str(document["origin"])[:ORIGIN_MAX]} if document["origin"] else {}
    text = tomli_w.dumps({"title": str(document["title"])[:TITLE_MAX], **origin, "craft": document["craft"]})
    # A list of numbers on one line; its texts have no line breaks.
    return _LIST.sub(lambda match: f"[{' '.join(match[1].split())}]", text)
