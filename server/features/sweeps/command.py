"""`mucat scenario sweep`: vary a scenario's entries, from a shell."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from server.platform.command_line import FILE, CommandError, with_settings

if TYPE_CHECKING:
    from server.platform.settings import Settings


@click.command()
@click.argument("file", type=FILE, metavar="FILE")
@click.option("--table", type=FILE, help="Write the runs with their figures as CSV.")
@click.option("--scheduler", metavar="ADDRESS", help="Compute on a Dask cluster: tls://NAME:PORT.")
@click.option("--certificates", type=FILE, help="The folder with ca.pem, certificate.pem and key.pem for it.")
@click.option(
    "--workers", type=click.IntRange(min=1), help="Processes on this computer.  [default: its cores]"
)
@with_settings
def sweep(
    settings: "Settings",
    file: Path,
    table: Path | None,
    scheduler: str | None,
    certificates: Path | None,
    workers: int | None,
) -> int:
    """Run a scenario with varied entries, each variant with the same seeds.

    Figures that are computed already are not computed again: after Ctrl-C the same command goes on.
    """
    from robot_runtime.contract.limits import ConfigError
    from robot_runtime.contract.text_input import TextError, load_text
    from server.features.sweeps.config import SweepsConfig
    from server.features.sweeps.shell_sweep import run_sweep

    try:
        text = load_text(file)
    except TextError as problem:
        raise CommandError(f"{file} cannot be read: it {problem}") from problem
    except OSError as problem:
        raise CommandError(f"{file} cannot be read: {problem.strerror}.") from problem
    config = settings.section(SweepsConfig)
    try:
        chosen = replace(
            config,
            scheduler=config.scheduler if scheduler is None else scheduler,
            certificates=config.certificates if certificates is None else str(certificates),
            workers=workers or config.workers,
        )
        return run_sweep(text, table, settings, chosen, own=chosen != config)
    except ConfigError as problem:
        raise CommandError("\n  ".join([f"{file} cannot be run:", *problem.texts])) from problem
