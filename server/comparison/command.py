"""`mucat report`: a comparison as an HTML file, from a shell."""

import argparse
import sqlite3
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, closing, contextmanager

from migrations import HEAD
from server.comparison.alignment import Align
from server.comparison.comparing import Comparer
from server.comparison.report import write_report
from server.comparison.shapes import DEFAULT_SIGNALS, SESSIONS_MAX, NoSessionError, WantedComparison
from server.recording import RecordingError
from server.schema import prepare, read_revision
from server.settings import DataFolder, Settings, SetupError
from server.store import Store, StoreError

Claim = Callable[[DataFolder], AbstractContextManager[None]]

POINTS = 2000


def perform(options: argparse.Namespace, settings: Settings, claim: Claim) -> int:
    """Write the report. Raises SetupError, with a line for a person, where it cannot be done."""
    if len(options.sessions) > SESSIONS_MAX:
        raise SetupError(f"A report holds {SESSIONS_MAX} sessions at most.")
    by = "marker" if options.marker else options.align
    align = {"by": by, "number": options.step, "marker": options.marker}
    try:
        wanted = WantedComparison(
            sessions=options.sessions,
            signals=list(options.signals or DEFAULT_SIGNALS),
            align=Align.model_validate(align),
            points=POINTS,
        )
        with _open(settings.data, claim) as store:
            text = write_report(Comparer(store).compare(wanted))
        options.out.write_text(text, encoding="utf-8")
    except ValueError as problem:
        raise SetupError(f"The report cannot be made: {problem}") from problem
    except (NoSessionError, RecordingError) as problem:
        raise SetupError(str(problem)) from problem
    except StoreError as problem:
        raise SetupError(f"The database {settings.data.database} fails: {problem}") from problem
    except OSError as problem:
        raise SetupError(f"{options.out} cannot be written: {problem.strerror}.") from problem
    print(f"{options.out}")  # noqa: T201 - a command line speaks
    return 0


@contextmanager
def _open(folder: DataFolder, claim: Claim) -> Iterator[Store]:
    # Only reads, so it may be done beside a running server; making or upgrading a database may not.
    try:
        current = read_revision(folder.database) == HEAD
    except sqlite3.DatabaseError:
        current = False  # `prepare` says what is the matter
    if not current:
        with claim(folder):
            prepare(folder)
    with closing(Store(folder.database)) as store:
        yield store
