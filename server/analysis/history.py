"""Armed periods and settings in force of a session, from state documents, events and bookmarks."""

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np
from sqlmodel import col, select

from robot_runtime.contract.topics import CRAFT, PARAMETERS, STATE, STATUS, TRUTH
from server.analysis.moments import (
    CardChange,
    ControlHistory,
    ControlPeriod,
    ModePeriod,
    ParameterValues,
    Span,
)
from server.analysis.samples import Samples
from server.library.bookmarks import name_note
from server.library.content import Recording, depth_loop
from server.library.crafts import read_crafts, which_water
from server.library.timeline import Moment
from server.metrics.series import Series
from server.platform.models import BookmarkRow, Gap
from server.platform.store import Reader

ARMED_FLAG = 1
"""The bit of status.flags, see robot_runtime.contract.packets.StatusFlag."""
STEP_LEAST = 0.001
"""m; smaller changes of a set point are rounding."""


def read_history(recording: Recording, samples: Samples) -> ControlHistory:
    """Return the history from the state documents; without these the armed spans from the board's flags.

    Raise StoreError, RecordingError.
    """
    origin, end = recording.row.started_steady, recording.row.duration
    there = {topic.name for topic in (CRAFT, STATUS, TRUTH) if recording.has(topic.name)}
    water, crafts = which_water(there), tuple(read_crafts(recording))
    changes = list(recording.changes(STATE.name)) if STATE.name in recording.topics else []
    if not changes:
        flags = samples.read(recording, ["status.flags"]).get("status.flags")
        armed = _spans_of_flags(flags) if flags is not None else ()
        began = bool(armed) and _began_armed(armed, flags)
        return ControlHistory(armed, began, (), {}, water=water, crafts=crafts)
    armed = tuple(_spans_of_states(changes, origin, end))
    before = [change for change in changes if not armed or change["time"] - origin <= armed[0].start]
    return ControlHistory(
        armed=armed,
        armed_at_start=bool(changes[0].get("armed")) and changes[0].get("armed_since") is None,
        controls=tuple(_controls(changes, origin)),
        state=(before or changes[:1])[-1],
        parameters=tuple(_parameter_values(recording, origin)),
        modes=tuple(_modes(changes, origin)),
        cards=tuple(_card_changes(changes, origin)),
        water=water,
        crafts=crafts,
    )


def set_point_steps(set_point: Series, armed: tuple[Span, ...]) -> list[tuple[float, float]]:
    """Return time and new value of each change of the set point (m) while armed."""
    values, times = set_point.values, set_point.times
    at = np.flatnonzero(np.abs(np.diff(values)) > STEP_LEAST) + 1
    return [
        (float(times[index]), float(values[index]))
        for index in at
        if any(span.start < times[index] <= span.end for span in armed)
    ]


def read_bookmarks(store: Reader, recording: Recording) -> list[Moment]:
    """Return the session's bookmarks in order of time. Raise StoreError."""
    row = recording.row
    query = select(BookmarkRow).where(BookmarkRow.session_id == row.id).order_by(col(BookmarkRow.time))
    with store.read() as database:
        return [
            Moment(bookmark.time - row.started_steady, "marker", "info", name_note(bookmark.text))
            for bookmark in database.exec(query)
        ]


def read_gaps(store: Reader, recording: Recording) -> list[Gap]:
    """Return the gaps of the recording. Raise StoreError."""
    query = select(Gap).where(Gap.session_id == recording.row.id).order_by(col(Gap.time))
    with store.read() as database:
        return list(database.exec(query))


def _spans_of_states(changes: list[dict[str, Any]], origin: float, end: float) -> Iterator[Span]:
    since: float | None = None
    for document in changes:
        now = document["time"] - origin
        if document.get("armed") and since is None:
            armed_since = document.get("armed_since")
            since = (armed_since if isinstance(armed_since, int | float) else document["time"]) - origin
        elif not document.get("armed") and since is not None:
            yield Span(since, now)
            since = None
    if since is not None:
        yield Span(since, max(end, since))


def _card_changes(changes: list[dict[str, Any]], origin: float) -> Iterator[CardChange]:
    for before, document in pairwise(changes):
        if before.get("card") != document.get("card"):
            yield CardChange(document["time"] - origin, document.get("card"))


def _modes(changes: list[dict[str, Any]], origin: float) -> Iterator[ModePeriod]:
    before: tuple[str, bool] | None = None
    for document in changes:
        mode = str(document.get("mode", ""))
        # In automatic the depth is held whatever the loop says; a pilot may have it held, too.
        now = mode, mode == "automatic" or (mode == "manual" and bool(depth_loop(document).get("on")))
        if now != before:
            before = now
            yield ModePeriod(document["time"] - origin, *now)


def _spans_of_flags(flags: Series) -> tuple[Span, ...]:
    on = (flags.values.astype(np.int64) & ARMED_FLAG).astype(np.int8)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], on, [0]])))
    last = flags.times.size - 1
    return tuple(
        Span(float(flags.times[first]), float(flags.times[min(after, last)]))
        for first, after in edges.reshape(-1, 2)
    )


def _began_armed(armed: tuple[Span, ...], flags: Series | None) -> bool:
    return flags is not None and armed[0].start == flags.times[0]


def _parameter_values(recording: Recording, origin: float) -> Iterator[ParameterValues]:
    if PARAMETERS.name in recording.topics:
        for document in recording.changes(PARAMETERS.name):
            values = {parameter["name"]: parameter["value"] for parameter in document["parameters"]}
            yield ParameterValues(document["time"] - origin, values)


def _controls(changes: list[dict[str, Any]], origin: float) -> Iterator[ControlPeriod]:
    before: tuple[str, dict[str, float]] | None = None
    for document in changes:
        loop = depth_loop(document)
        name = str(loop.get("controller", ""))
        chosen = next(
            (controller for controller in loop.get("controllers", []) if controller.get("name") == name), None
        )
        gains = {gain["name"]: float(gain["value"]) for gain in chosen["gains"]} if chosen else {}
        if (name, gains) != before:
            before = name, gains
            title = str(chosen.get("title", name)) if chosen else name
            yield ControlPeriod(document["time"] - origin, name, gains, title)
