"""`mucat run`: starts everything and serves the page."""

import os
import signal
import sys
import traceback
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import click

from robot_runtime.simulation.boards.mistakes import check_mistake, write_list
from server.features.doors.config import DoorsConfig
from server.platform.command_line import CommandError, with_settings
from server.platform.folder_lock import claim
from server.platform.last_configuration import keep_configuration
from server.platform.settings import DataFolder, Settings, SetupError, keep_config

if TYPE_CHECKING:
    from fastapi import FastAPI

    from server.container import Container
    from server.http.serving import WebServer
    from server.http.sign_in.access import Access
    from server.platform.certificate import Certificate

BYTES_MAX = 500_000_000
"""Of the server's own memory: five times what it needs. An attack once brought it to 1.4 GB. Where systemd
starts it, its unit sets a limit as well, which only a kernel with the memory cgroup observes."""


def _read_mistakes(_: click.Context, __: click.Parameter, texts: tuple[str, ...]) -> tuple[str, ...]:
    try:
        for text in texts:
            check_mistake(text)
    except ValueError as problem:
        raise click.BadParameter(str(problem)) from problem
    return texts


@click.command(epilog="\n".join(["\b", "Mistakes:", *(f"  {line}" for line in write_list())]))
@click.option("--port", type=int, help="Default: server.port in robot.toml, or 8000.")
@click.option("--host", help="Address to listen on. Default: server.host in robot.toml, or 127.0.0.1.")
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
    with claim(settings.data):
        if uncalibrated:
            settings.data.board_eeprom.unlink(missing_ok=True)
        if external_runtime:
            keep_configuration(settings)
        return _serve(keep_config(settings))


def _serve(settings: Settings) -> int:
    # Loaded only now: an error in robot.toml is reported at once, also on a slow computer.
    from robot_runtime.transport.lifetime import limit_memory
    from server.http.listener import open_socket
    from server.processes.server_runner import ServerRunner

    ros2 = settings.section(DoorsConfig).ros2
    if settings.zenoh.listen or ros2:
        from server.platform.authority import Authority

        Authority(settings).prepare()
    if ros2:
        from server.features.doors.ros2_door import check_ros2

        check_ros2(settings)
    if settings.emulated_board:
        _prepare_board(settings)
    with open_socket(settings.host, settings.port) as listener:
        certificate = _prepare_certificate(settings) if settings.tls else None
        # The runner's libraries are a second copy as soon as the server has used them, 30 MB: a small
        # computer has them once, and loads them again where its server was killed.
        loaded = None if settings.profile == "lean" else _load(settings, certificate)

        def serve(ended: str, note_serving: Callable[[], None]) -> int:
            """Serve in a process of its own; `ended` describes the end of the server before it, if any."""
            from server.platform.running_server import announce

            limit_memory(BYTES_MAX)
            if not _prepare_database(settings.data):
                return 1
            announce(settings)
            app, server = loaded or _load(settings, certificate)
            # The server ends in order at these, and then sends them to itself once more; once is enough.
            for number in (signal.SIGINT, signal.SIGTERM):
                signal.signal(number, lambda *_: None)
            app.state.ended, app.state.note_serving = ended, note_serving
            server.run(sockets=[listener])
            return 0

        return ServerRunner(serve, settings.data).run()


def _prepare_board(settings: Settings) -> None:
    from robot_runtime.simulation.boards.emulator_process import BoardError, check_emulator
    from robot_runtime.simulation.boards.firmware import FirmwareBuildError, build_firmware

    try:
        build_firmware(settings.build, settings.link.baud, hil=settings.in_the_loop)
        check_emulator(settings.build / "board")
    except (FirmwareBuildError, BoardError) as problem:
        raise SetupError(str(problem)) from problem


def _prepare_certificate(settings: Settings) -> "Certificate":
    from server.platform.certificate import prepare_certificate

    return prepare_certificate(settings)


def _prepare_database(folder: DataFolder) -> bool:
    """Upgrades the database in a process of its own, whose libraries nobody needs afterwards.

    Returns False where it cannot be used, which is said. No thread may run yet.
    """
    pid = os.fork()
    if pid == 0:
        status = 1
        try:
            from server.platform.schema import prepare

            prepare(folder)
            status = 0
        except SetupError as problem:
            CommandError(str(problem)).show()
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stderr.flush()
            os._exit(status)
    return os.waitpid(pid, 0)[1] == 0


def _load(settings: Settings, certificate: "Certificate | None") -> tuple["FastAPI", "WebServer"]:
    """Loads the server's libraries, and makes the application and its server."""
    from robot_runtime.service_manager import ServiceManager
    from server.app import create_app
    from server.http.serving import make_server
    from server.http.sign_in.access import Access
    from server.processes.supervisor import plan

    def started(container: "Container") -> None:
        container.warm_up()
        app.state.note_serving()
        ServiceManager().ready()
        if not app.state.ended:
            _greet(settings, container.services.get(Access), certificate)

    app = create_app(settings, plan(settings), started)
    server = make_server(app, certificate, settings.trusted_proxies)
    server.config.load()
    return app, server


def _greet(settings: Settings, access: "Access", certificate: "Certificate | None") -> None:
    from server.features.people.welcome import shows_pictures, welcome

    lines = welcome(settings, access, certificate, picture=shows_pictures(sys.stdout))
    click.echo("\n".join(lines))
