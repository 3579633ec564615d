"""`mucat run`: starts everything and serves the page."""

import signal
from collections.abc import Callable
from dataclasses import replace
from pkgutil import resolve_name

import click

from robot_runtime.durable_files import write_whole
from robot_runtime.simulation.boards.mistakes import check_mistake, write_list
from server.feature import list_features
from server.platform.command_line import with_settings
from server.platform.folder_lock import claim
from server.platform.lab_config import LabConfig
from server.platform.last_configuration import keep_configuration
from server.platform.settings import Settings, SetupError, keep_config

BYTES_MAX = 500_000_000
"""Of the server's own memory: five times what it needs. An attack once brought it to 1.4 GB. Where systemd
starts it, its unit sets a limit as well, which only a kernel with the memory cgroup observes."""

PORT = click.option("--port", type=int, help="Default: server.port in robot.toml, or 8000.")
HOST = click.option("--host", help="Address to listen on. Default: server.host in robot.toml, or 127.0.0.1.")


def _read_mistakes(_: click.Context, __: click.Parameter, texts: tuple[str, ...]) -> tuple[str, ...]:
    try:
        for text in texts:
            check_mistake(text)
    except ValueError as problem:
        raise click.BadParameter(str(problem)) from problem
    return texts


@click.command(epilog="\n".join(["\b", "Mistakes:", *(f"  {line}" for line in write_list())]))
@PORT
@HOST
@click.option(
    "--mistake",
    "mistakes",
    multiple=True,
    callback=_read_mistakes,
    metavar="NAME",
    help="A mistake that the emulated board has, from the list below. Can be repeated.",
)
@click.option(
    "--uncalibrated",
    is_flag=True,
    help="The emulated board begins as the factory delivers it: not calibrated.",
)
@click.option(
    "--external-runtime",
    is_flag=True,
    help="The robot's runtime is a service of its own (mucat runtime); this server does not start or end it.",
)
@with_settings
def run(settings: Settings, mistakes: tuple[str, ...], *, uncalibrated: bool, external_runtime: bool) -> int:
    """Start everything and serve the page."""
    if mistakes and not settings.emulated_board:
        raise SetupError("--mistake is for the emulated board; robot.toml has a real one (robot.mode).")
    if uncalibrated and not settings.emulated_board:
        raise SetupError("--uncalibrated is for the emulated board; robot.toml has a real one (robot.mode).")
    settings = replace(
        settings, mistakes=mistakes, uncalibrated=uncalibrated, external_runtime=external_runtime
    )
    if settings.lab:
        raise SetupError(
            f"{settings.data.path} is a lab's. Start it with `mucat lab run`, or choose "
            "another folder with --data."
        )
    with claim(settings.data):
        if uncalibrated:
            settings.data.board_eeprom.unlink(missing_ok=True)
        if external_runtime:
            keep_configuration(settings)
        return _serve(keep_config(settings))


@click.command("run")
@PORT
@HOST
@with_settings
def run_lab(settings: Settings) -> int:
    """Serve a lab: the page and the archive of several robots, without a robot."""
    with claim(settings.data):
        keep_configuration(settings)
        return _serve(keep_config(_become_lab(settings)))


def _become_lab(settings: Settings) -> Settings:
    """Mark the data folder as a lab's. Raise SetupError where a robot uses it, or it cannot be written."""
    folder = settings.data
    if not settings.lab and folder.database.exists():
        raise SetupError(
            f"{folder.path} has the recordings of a robot. Choose another folder for the lab, with --data."
        )
    try:
        write_whole(folder.lab, settings.section(LabConfig).database.encode())
    except OSError as problem:
        raise SetupError(f"{folder.lab} cannot be written: {problem.strerror}.") from problem
    return replace(settings, lab=True)


def _serve(settings: Settings) -> int:
    # Loaded only now: an error in robot.toml is reported at once, also on a slow computer.
    from robot_runtime.transport.lifetime import limit_memory
    from server.http.listener import open_socket
    from server.platform.certificate import prepare_certificate
    from server.platform.database_upgrade import upgrade_apart
    from server.processes.emulated_board import prepare_board
    from server.processes.server_runner import ServerRunner

    if settings.zenoh.listen:
        from server.platform.authority import Authority

        Authority(settings).prepare()
    for feature in list_features().values():
        if feature.prepare and settings.has(feature):
            resolve_name(feature.prepare)(settings)
    if settings.emulated_board and not settings.lab:
        prepare_board(settings)
    with open_socket(settings.server.host, settings.server.port) as listener:
        certificate = prepare_certificate(settings) if settings.server.tls else None
        # The runner's libraries are a second copy as soon as the server has used them, 30 MB: a small
        # computer has them once, and loads them again where its server was killed.
        loaded = None
        if settings.robot.profile != "lean":
            from server.loading import load

            loaded = load(settings, certificate)

        def serve(ended: str, note_serving: Callable[[], None]) -> int:
            """Serve in a process of its own; `ended` describes the end of the server before it, if any."""
            from server.loading import load
            from server.platform.running_server import announce

            limit_memory(BYTES_MAX)
            if not upgrade_apart(settings.data):
                return 1
            announce(settings)
            app, server = loaded or load(settings, certificate)
            # The server ends in order at these, and then sends them to itself once more; once is enough.
            for number in (signal.SIGINT, signal.SIGTERM):
                signal.signal(number, lambda *_: None)
            app.state.ended, app.state.note_serving = ended, note_serving
            server.run(sockets=[listener])
            return 0

        return ServerRunner(serve, settings.data).run()
