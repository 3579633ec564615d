"""`mucat report`: a comparison as an HTML file, from a shell."""

from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from server.platform.command_line import FILE, CommandError, RowCommand, name_error, with_settings
from server.platform.name_completion import SESSION_NUMBER
from server.platform.terminal import echo

if TYPE_CHECKING:
    from server.platform.settings import Settings


@click.command(cls=RowCommand)
@click.argument("sessions", type=SESSION_NUMBER, nargs=-1, required=True, metavar="SESSION...")
@click.option("-o", "--out", type=FILE, default="report.html", help="The file to write.")
@click.option(
    "--align",
    type=click.Choice(["start", "armed", "set_point", "segment"]),
    default="armed",
    help="The moment of each session that is 0 s.",
)
@click.option(
    "--step",
    type=click.IntRange(min=1),
    default=1,
    help="Which step of the set point, for --align set_point.",
)
@click.option("--marker", help="Align at the bookmark of this text instead.")
@click.option("--mission-step", metavar="PATH", help="Align at the start of a mission's step instead: 3.1.2.")
@click.option(
    "--over",
    type=click.Choice(["armed", "segment"]),
    default="armed",
    help="What the figures cover: the time armed, or a segment of each session.",
)
@click.option(
    "--segments",
    default="",
    metavar="7:2,9:1",
    help="The segments: of session 7 the second, of 9 the first. Default: those most alike.",
)
@click.option(
    "--signals",
    multiple=True,
    metavar="TOPIC.COLUMN...",
    help="The signals to draw. Default: those of the thesis's figures.",
)
@with_settings
def report(
    settings: "Settings",
    sessions: tuple[int, ...],
    out: Path,
    align: str,
    step: int,
    marker: str | None,
    mission_step: str | None,
    over: Literal["armed", "segment"],
    segments: str,
    signals: tuple[str, ...],
) -> None:
    """Compare sessions in an HTML file."""
    from pydantic import ValidationError

    from server.analysis.alignment import Align
    from server.analysis.comparer import Comparer
    from server.analysis.report import write_report
    from server.analysis.schemas import (
        DEFAULT_SIGNALS,
        REPORT_POINTS,
        SESSIONS_MAX,
        ComparisonQuery,
        read_segments,
    )
    from server.platform.shell_store import open_reader

    if len(sessions) > SESSIONS_MAX:
        raise CommandError(f"A report holds {SESSIONS_MAX} sessions at most.")
    by = "marker" if marker else "mission" if mission_step is not None else align
    moment = {"by": by, "number": step, "marker": marker or "", "step": mission_step or ""}
    try:
        query = ComparisonQuery(
            sessions=list(sessions),
            signals=list(signals or DEFAULT_SIGNALS),
            align=Align.model_validate(moment),
            points=REPORT_POINTS,
            over=over,
            segments=read_segments(segments),
        )
        with open_reader(settings.data) as store:
            text = write_report(Comparer(store).compare(query))
        out.write_text(text, encoding="utf-8")
    except ValidationError as problem:
        raise CommandError("; ".join(name_error(error) for error in problem.errors())) from problem
    except ValueError as problem:
        raise CommandError(f"The report cannot be made: {problem}") from problem
    except OSError as problem:
        raise CommandError(f"{out} cannot be written: {problem.strerror}.") from problem
    echo(out)
