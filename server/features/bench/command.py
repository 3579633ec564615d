"""`mucat bench`: measures the running robot's software on this computer."""

from functools import partial

import click

from server.platform.command_line import CommandError, with_settings
from server.platform.running_server import ask
from server.platform.settings import Settings
from server.platform.terminal import echo


@click.command()
@click.option(
    "--seconds",
    type=click.IntRange(10, 3600),
    default=60,
    help="How long a session is recorded and measured.",
)
@with_settings
def bench(settings: Settings, seconds: int) -> None:
    """Measure what the robot's software costs on this computer, while the robot runs.

    It records a session with one viewer, removes it again, and prints a table for others to read. A session
    that records already is measured and stays. Nothing is armed: arm the robot before to
    measure it swimming.
    """
    # Loaded only now: NumPy and SQLAlchemy take seconds on a slow computer.
    from server.features.bench.measurement import measure_load, measure_start
    from server.features.bench.report import write_report

    tell = partial(echo, err=True)
    try:
        dive = measure_load(settings.data, float(seconds), tell)
        state = ask(settings.data, "GET", "/robot")
        tell("A second server is started and ended ...")
        start = measure_start()
    except PermissionError as problem:
        raise CommandError(
            f"This user may not read {problem.filename}. On an installed robot: sudo mucat bench"
        ) from problem
    echo(write_report(start, dive, state))
