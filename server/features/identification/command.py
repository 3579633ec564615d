"""`mucat identify`: fits a craft to recorded sessions, from a shell."""

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from server.platform.command_line import FILE, CommandError, with_settings
from server.platform.name_completion import SESSION_NUMBER
from server.platform.terminal import echo

if TYPE_CHECKING:
    from click._termui_impl import ProgressBar

    from server.features.identification.schemas import IdentificationResult
    from server.platform.settings import Settings


@click.command()
@click.argument("sessions", type=SESSION_NUMBER, nargs=-1, required=True, metavar="SESSION...")
@click.option(
    "--leave-out", type=SESSION_NUMBER, metavar="SESSION", help="A session that checks the prediction."
)
@click.option("-o", "--out", type=FILE, default="craft.toml", help="The craft file to write.")
@click.option("--report", type=FILE, help="Also write an HTML file with measured over predicted signals.")
@with_settings
def identify(
    settings: "Settings", sessions: tuple[int, ...], leave_out: int | None, out: Path, report: Path | None
) -> None:
    """Fit drag, thrust, trim and sensors of the craft in force to sessions.

    The result is a craft file; name it in robot.toml under [craft] to use it.
    """
    from robot_runtime.contract.limits import ConfigError
    from server.features.identification.report import write_identification_report
    from server.features.identification.run import check_choice, run_identification
    from server.features.identification.schemas import SESSIONS_MAX
    from server.platform.shell_store import open_reader

    if len(sessions) > SESSIONS_MAX:
        raise CommandError(f"A fit takes {SESSIONS_MAX} sessions at most.")
    check_choice(sessions, leave_out)
    for path in (out, *([report] if report else [])):
        if not os.access(path if path.exists() else path.absolute().parent, os.W_OK):
            raise CommandError(f"{path} cannot be written. Name another file.")
    try:
        start = settings.read_craft()
        with open_reader(settings.data) as store, _progress() as bar:
            result = run_identification(
                store, sessions, leave_out, start, lambda share: bar.update(round(100 * share) - bar.pos)
            )
    except ConfigError as problem:
        raise CommandError(f"{problem}. Correct or remove the craft file.") from problem
    _print(result)
    _write(out, result.craft)
    if report is not None:
        _write(report, write_identification_report(result))


def _progress() -> "ProgressBar[int]":
    return click.progressbar(range(100), label="Fitting", file=sys.stderr)


def _print(result: "IdentificationResult") -> None:
    from server.features.identification.schemas import describe_improvement

    width = max(len(number.title) for number in result.numbers)
    echo(f"{'':<{width}}  {'before':>10}  {'found':>10}")
    for number in result.numbers:
        value = "" if number.deviation is None else f"{number.value:.4g}"
        echo(f"{number.title:<{width}}  {number.before:>10.4g}  {value:>10}  {number.words}".rstrip())
    for sensor, sigma in result.noise.items():
        echo(f"Noise of the {sensor}: {sigma:.3g}")
    for motion in result.missing:
        echo(f"Not seen in these sessions, and as before. {motion}.")
    check = result.check
    if check is None:
        echo("No session was left out, so nothing checks the result: use --leave-out.")
    else:
        echo(
            f"Prediction of {check.name}, which was left out: the error is {100 * check.after_error:.1f} % "
            f"of what the signals vary, before {100 * check.before_error:.0f} %: "
            f"{describe_improvement(check.improvement)}."
        )


def _write(path: Path, text: str) -> None:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as problem:
        raise CommandError(f"{path} cannot be written: {problem.strerror}.") from problem
    echo(path)
