"""Alignment of sessions: the moment of each that becomes 0 s."""

from typing import Annotated, Literal

from pydantic import Field

from server.analysis.likeness import NO_SEGMENT
from server.analysis.moments import ControlHistory, Span
from server.http.request_body import RequestBody
from server.library.bookmarks import name_note
from server.library.missions import RecordedMission
from server.library.timeline import Moment


class Align(RequestBody):
    """The moment that becomes 0 s in every session."""

    by: Literal["start", "armed", "set_point", "marker", "mission", "segment"] = "start"
    number: Annotated[int, Field(ge=1, le=1000, description="number of the set-point step")] = 1
    marker: Annotated[str, Field(max_length=500, description="its name; the first match counts")] = ""
    step: Annotated[
        str,
        Field(pattern=r"^(\d{1,3}(\.\d{1,3}){0,7})?$", description="of the mission, as “3.1.2”"),
    ] = ""


class NoMomentError(Exception):
    """The session lacks the moment; the text says why."""


def find_moment(
    align: Align,
    history: ControlHistory,
    steps: list[tuple[float, float]],
    bookmarks: list[Moment],
    missions: list[RecordedMission],
    segment: Span | None,
) -> float:
    """Return the moment, s since the session's start; `segment` is the chosen one.

    Raise NoMomentError if the session lacks it.
    """
    if align.by == "segment":
        if segment is None:
            raise NoMomentError(NO_SEGMENT)
        return segment.start
    if align.by == "armed":
        if not history.armed:
            raise NoMomentError("The robot was never armed in this session.")
        if history.armed_at_start:
            raise NoMomentError("The robot was armed already when this recording began.")
        return history.armed[0].start
    if align.by == "set_point":
        if len(steps) < align.number:
            raise NoMomentError(_too_few(align.number, len(steps)))
        return steps[align.number - 1][0]
    if align.by == "marker":
        sought = name_note(align.marker).casefold()
        for bookmark in bookmarks:
            if bookmark.text.casefold() == sought:
                return bookmark.time
        raise NoMomentError(f"This session has no bookmark “{align.marker}”.")
    if align.by == "mission":
        return _find_step(align.step, missions)
    return 0.0


def _find_step(path: str, missions: list[RecordedMission]) -> float:
    """Return the first start of the step at this path, in the first mission where it began."""
    if not missions:
        raise NoMomentError("No mission ran in this session.")
    for mission in missions:
        for step in mission.started:
            if step.path == path:
                if mission.late and step.time <= mission.start:
                    raise NoMomentError(f"The mission “{mission.mission.title}” began before this recording.")
                return step.time
    names = " and ".join(
        f"“{title}”" for title in dict.fromkeys(mission.mission.title for mission in missions)
    )
    if any(step.path == path for mission in missions for step in mission.mission.steps):
        raise NoMomentError(f"Step {path} of the mission {names} never began.")
    raise NoMomentError(f"The mission {names} has no step {path}.")


def _too_few(sought: int, there: int) -> str:
    if there == 0:
        return "The set point never changed while the robot was armed."
    times = "once" if there == 1 else f"{there} times"
    return f"The set point changed only {times} while the robot was armed, so there is no step {sought}."
