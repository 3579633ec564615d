"""The tasks of the comparing process, and their answers."""

import json
import traceback
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from pydantic import TypeAdapter

from server.analysis.archive_figures import list_figures
from server.analysis.comparer import Comparer
from server.analysis.figure_schemas import FigureSet
from server.analysis.report import write_report
from server.analysis.schemas import ComparisonQuery, LinesQuery, ReportQuery, StoryFiguresQuery
from server.analysis.signals import Signal
from server.analysis.story_schemas import Spectrum, StudyQuery, SwumTrack
from server.analysis.summary import summarise
from server.platform.errors import ApiError, UnavailableError
from server.platform.store import Reader
from server.processes.task_process import write_answer

TOO_LARGE = "This takes more memory than it may. Choose fewer sessions, or fewer signals."

Task = Callable[[Comparer, str], bytes]


def compare(comparer: Comparer, query: str) -> bytes:
    """Return a comparison, as JSON."""
    return comparer.compare(ComparisonQuery.model_validate_json(query)).model_dump_json().encode()


def lines(comparer: Comparer, query: str) -> bytes:
    """Return the lines of a part, as JSON."""
    return comparer.lines(LinesQuery.model_validate_json(query)).model_dump_json().encode()


def signals(comparer: Comparer, query: str) -> bytes:
    """Return the signals of the session of this number, as JSON."""
    return TypeAdapter(list[Signal]).dump_json(comparer.signals(json.loads(query)))


def report(comparer: Comparer, query: str) -> bytes:
    """Return a report, as HTML."""
    asked = ReportQuery.model_validate_json(query)
    return write_report(comparer.compare(asked.parse()), asked.shown).encode()


def story(comparer: Comparer, query: str) -> bytes:
    """Return the story of the session of this number, as JSON."""
    return comparer.stories.tell(json.loads(query)).model_dump_json().encode()


def track(comparer: Comparer, query: str) -> bytes:
    """Return the tracks of the session of this number, as JSON."""
    return TypeAdapter(list[SwumTrack]).dump_json(comparer.stories.track(json.loads(query)))


def story_figures(comparer: Comparer, query: str) -> bytes:
    """Return the figures of a story, as JSON."""
    asked = StoryFiguresQuery.model_validate_json(query)
    return comparer.stories.measure(asked.session, asked.part).model_dump_json().encode()


def spectrum(comparer: Comparer, query: str) -> bytes:
    """Return the spectra of signals, as JSON."""
    spectra = comparer.study.find_spectra(StudyQuery.model_validate_json(query))
    return TypeAdapter(list[Spectrum]).dump_json(spectra)


def pair(comparer: Comparer, query: str) -> bytes:
    """Return one signal against another, as JSON."""
    return comparer.study.pair(StudyQuery.model_validate_json(query)).model_dump_json().encode()


def summary(comparer: Comparer, query: str) -> bytes:
    """Return the summary of the session of this number, as JSON."""
    return summarise(comparer.reader, json.loads(query)).model_dump_json().encode()


def figures(comparer: Comparer, query: str) -> bytes:
    """Return the figures of the session of this number that an archive keeps, as JSON."""
    return TypeAdapter(list[FigureSet]).dump_json(list_figures(comparer, json.loads(query)))


TASKS: Mapping[str, Task] = {
    "compare": compare,
    "lines": lines,
    "signals": signals,
    "report": report,
    "story": story,
    "track": track,
    "story_figures": story_figures,
    "spectrum": spectrum,
    "pair": pair,
    "summary": summary,
    "figures": figures,
}


def answer_all(database: Path | str, tasks: Iterable[bytes]) -> None:
    """Answer each task, a line of JSON, on the standard output."""
    reader = Reader(database)
    comparer = Comparer(reader)
    for line in tasks:
        asked = json.loads(line)
        try:
            write_answer(200, TASKS[asked["task"]](comparer, asked["query"]))
        except ApiError as problem:
            write_answer(problem.status, problem.detail.encode())
        except MemoryError:
            # What the caches hold would be in the way of all that follows.
            comparer = Comparer(reader)
            write_answer(422, TOO_LARGE.encode())
        except Exception as problem:
            # Whatever it is, the server says it, and the next task is answered.
            traceback.print_exc()
            why = f"The sessions cannot be compared: {type(problem).__name__}: {problem}"
            write_answer(UnavailableError.status, why.encode(errors="replace"))
