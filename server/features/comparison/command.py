"""`mucat report`: a comparison as an HTML file, from a shell."""

import argparse

from server.features.comparison.alignment import Align
from server.features.comparison.comparer import Comparer
from server.features.comparison.report import write_report
from server.features.comparison.schemas import DEFAULT_SIGNALS, SESSIONS_MAX, NoSessionError, WantedComparison
from server.features.sessions.recording import RecordingError
from server.platform.running_server import Claim, open_reader
from server.platform.settings import Settings, SetupError
from server.platform.store import StoreError

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
        with open_reader(settings.data, claim) as store:
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
