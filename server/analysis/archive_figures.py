"""Figures of a session and of each of its segments, as an archive keeps them to compare thousands."""

from collections.abc import Mapping

from server.analysis.comparer import Comparer
from server.analysis.figure_schemas import FigureSet
from server.library.content import RecordingError
from server.library.crafts import describe_crafts, read_crafts
from server.metrics.figure import Figure


def list_figures(comparer: Comparer, session: int) -> list[FigureSet]:
    """Return the figures of a session that has ended: whole, then of its segments.

    Raise UnknownSessionError, StoreError. Of damaged samples there are none.
    """
    recording = comparer.reader.open(session)
    try:
        figures = comparer.stories.measure(session, None)
        segments = comparer.reader.segments(recording)
        craft = describe_crafts(comparer.reader.history(recording).water, read_crafts(recording))
    except RecordingError:
        return [FigureSet(segment=0, controller="", gains="", craft="", values={})]
    held = list(dict.fromkeys(segment.title for segment in segments if segment.holds_depth))
    gains = list(dict.fromkeys(write_gains(segment.gains) for segment in segments if segment.holds_depth))
    sets = [
        FigureSet(
            segment=0,
            controller=held[0] if len(held) == 1 else "",
            gains=gains[0] if len(gains) == 1 else "",
            craft=craft,
            values=_known(figures.whole),
        )
    ]
    for number, (segment, values) in enumerate(zip(segments, figures.segments, strict=False), 1):
        controller, chosen = (segment.title, write_gains(segment.gains)) if segment.holds_depth else ("", "")
        sets.append(
            FigureSet(segment=number, controller=controller, gains=chosen, craft=craft, values=_known(values))
        )
    return sets


def write_gains(gains: Mapping[str, float]) -> str:
    """Return gains as a text that is the same for the same gains."""
    return ", ".join(f"{name} {value:g}" for name, value in sorted(gains.items()))


def _known(figures: Mapping[str, Figure]) -> dict[str, float]:
    return {name: figure.value for name, figure in figures.items() if figure.value is not None}
