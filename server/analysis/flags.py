"""Flags of a dive: everything that happened at a moment, in one list."""

from collections.abc import Iterator
from itertools import chain, pairwise
from typing import Literal

from pydantic import Field

from robot_runtime.contract.documents import MISSION_MARK, Severity
from server.analysis.moments import ControlHistory
from server.library.missions import RecordedMission
from server.library.timeline import Moment
from server.platform.schema_base import Schema

FLAGS_MAX = 2000
"""Flags in one answer: the gravest, then the earliest."""
FlagKind = Literal["event", "alarm", "card", "bookmark", "controller", "gains", "set_point", "mission"]
_KINDS: dict[str, FlagKind] = {"controller": "controller", "set_point": "set_point", "mission": "mission"}
_GRAVITY: tuple[Severity, ...] = ("alarm", "caution", "info")


class Flag(Schema):
    """Something that happened at a moment of a dive."""

    time: float = Field(description="s since the session's start")
    kind: FlagKind
    severity: Severity
    text: str


def gather_flags(
    events: list[Moment], bookmarks: list[Moment], missions: list[RecordedMission], history: ControlHistory
) -> list[Flag]:
    """Return the flags in order of time; of too many the gravest."""
    marked = (
        Flag(
            time=mark.time, kind="bookmark", severity="info", text=mark.text.partition("\n")[0] or "Bookmark"
        )
        for mark in bookmarks
    )
    flags = [*chain(_of_events(events), marked, _of_missions(missions), _of_settings(history))]
    flags.sort(key=lambda flag: (_GRAVITY.index(flag.severity), flag.time))
    return sorted(flags[:FLAGS_MAX], key=lambda flag: flag.time)


def _of_events(events: list[Moment]) -> Iterator[Flag]:
    for event in events:
        # A mission's mark is a bookmark, too.
        if event.kind != MISSION_MARK:
            kind = "alarm" if event.severity == "alarm" else _KINDS.get(event.kind, "event")
            yield Flag(time=event.time, kind=kind, severity=event.severity, text=event.text)


def _of_missions(missions: list[RecordedMission]) -> Iterator[Flag]:
    for mission in missions:
        for step in mission.started:
            yield Flag(time=step.time, kind="mission", severity="info", text=step.words)


def _of_settings(history: ControlHistory) -> Iterator[Flag]:
    for change in history.cards:
        text = "No card" if change.card is None else f"{change.card.capitalize()} card"
        yield Flag(time=change.time, kind="card", severity="info", text=text)
    for before, after in pairwise(history.controls):
        if before.controller == after.controller:
            changed = [
                f"{name} {before.gains[name]:g} → {value:g}"
                for name, value in after.gains.items()
                if name in before.gains and before.gains[name] != value
            ]
            if changed:
                text = f"{after.title}: {', '.join(changed)}"
                yield Flag(time=after.time, kind="gains", severity="info", text=text)
