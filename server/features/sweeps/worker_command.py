"""`mucat worker`: compute runs of sweeps for a scheduler, from a shell."""

import asyncio
import signal
from pathlib import Path

import click

from server.platform.command_line import FILE, with_settings
from server.platform.settings import Settings, SetupError
from server.platform.terminal import echo


@click.command()
@click.option("--scheduler", metavar="ADDRESS", help="tls://NAME:PORT.  [default: that of [sweeps]]")
@click.option("--certificates", type=FILE, help="The folder with ca.pem, certificate.pem and key.pem.")
@with_settings
def worker(settings: Settings, scheduler: str | None, certificates: Path | None) -> int:
    """Compute runs of sweeps for a scheduler of Dask: one at a time, until Ctrl-C.

    Sweeps use only workers that have their software and compute the same bits.
    """
    from server.features.sweeps.config import NO_DASK, SweepsConfig, find_problem, has_dask

    config = settings.section(SweepsConfig)
    address = config.scheduler if scheduler is None else scheduler
    folder = config.certificates if certificates is None else str(certificates)
    if not address:
        raise SetupError("Name a scheduler: --scheduler tls://NAME:PORT.")
    if problem := find_problem(address, folder):
        raise SetupError(problem.text)
    if not has_dask():
        raise SetupError(NO_DASK)
    asyncio.run(_serve(address, folder))
    return 0


async def _serve(address: str, folder: str) -> None:
    from server.features.sweeps.cluster import serve_worker

    serving = asyncio.create_task(serve_worker(address, folder, echo))
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, serving.cancel)
    try:
        await serving
    except asyncio.CancelledError:
        echo("Ended.")
