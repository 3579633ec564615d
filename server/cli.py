"""`mucat`: the command line."""

import argparse
import fcntl
import logging
import os
import signal
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, TYPE_CHECKING

from robot_runtime.durable_files import make_folder
from server import VERSION
from server.features.exports.options import add_export, add_import
from server.features.people.options import add_access, add_pair
from server.features.sessions.options import add_record, add_sessions
from server.features.simulator import command as simulator_command
from server.platform.settings import DataFolder, Settings, SetupError, make_folders, read_settings
from server.processes.server_runner import ServerRunner, runner_of

if TYPE_CHECKING:
    from server.http.sign_in.access import Access
    from server.platform.certificate import Certificate

    Actions = argparse._SubParsersAction[argparse.ArgumentParser]

LOCK_TRIES = 20
LOCK_SECONDS = 0.02


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit status: 0 after an orderly end, 1 where what was asked cannot be done."""
    options = _options(arguments)
    logging.basicConfig(level=logging.WARNING, format="%(asctime)s %(levelname)s %(name)s: %(message)s")
    if options.command == "simulator":
        simulator_command.perform(options)
    try:
        settings = read_settings(options.config, options.data, options.host, options.port, os.environ)
        if options.command == "commtest":
            return _commtest(options, settings)
        if options.command == "scenario":
            return _scenario(options, settings)
        if options.command == "report":
            return _report(options, settings)
        if options.command in ("export", "import"):
            return _carry(options, settings)
        if options.command in ("sessions", "record"):
            return _sessions(options, settings)
        if options.command in ("pair", "access"):
            return _access(options, settings)
        if options.command in ("backup", "restore"):
            return _back_up(options, settings)
        with _claim(settings.data):
            return _run(settings)
    except SetupError as problem:
        return _complain(problem)


def _complain(problem: SetupError) -> int:
    print(f"mucat: {problem}", file=sys.stderr)  # noqa: T201 - a command line speaks
    return 1


def _options(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="mucat", description="The server of µ-CAT.")
    parser.add_argument("--version", action="version", version=f"mucat {VERSION}")
    commands = parser.add_subparsers(dest="command", required=True)
    kept = argparse.ArgumentParser(add_help=False)
    kept.add_argument("--data", type=Path, help="folder for everything kept; default $MUCAT_DATA, or data")
    kept.add_argument("--config", type=Path, default=Path("robot.toml"), help="default robot.toml")
    parser.set_defaults(host=None, port=None)
    run = commands.add_parser("run", parents=[kept], help="start everything and serve the page")
    run.add_argument("--port", type=int, help="default 8000, or server.port in robot.toml")
    run.add_argument("--host", help="address to listen on; default 127.0.0.1, or server.host in robot.toml")
    test = commands.add_parser("commtest", help="test the serial line, on the emulated board")
    _add_commtest(test.add_subparsers(dest="action", required=True), kept)
    simulator_command.add_arguments(commands)
    scenario = commands.add_parser("scenario", help="run experiments that are written down")
    _add_scenario(scenario.add_subparsers(dest="action", required=True), kept)
    report = commands.add_parser(
        "report", parents=[kept], help="lay sessions over each other in an HTML file"
    )
    _add_report(report)
    add_export(commands, kept)
    add_import(commands, kept)
    sessions = commands.add_parser("sessions", help="find sessions, write about them, delete them")
    add_sessions(sessions.add_subparsers(dest="action", required=True), kept)
    record = commands.add_parser("record", help="record with the running server")
    add_record(record.add_subparsers(dest="action", required=True), kept)
    _add_backup(commands, kept)
    add_pair(commands, kept)
    access = commands.add_parser("access", help="who may come in, in which role, and who no longer")
    add_access(access.add_subparsers(dest="action", required=True), kept)
    return parser.parse_args(arguments)


def _add_scenario(actions: "Actions", kept: argparse.ArgumentParser) -> None:
    actions.add_parser("list", parents=[kept], help="list the scenarios that there are")
    check = actions.add_parser("check", parents=[kept], help="say what is wrong with a scenario")
    check.add_argument("file", help="a TOML file, or the name of a scenario that there is")
    run = actions.add_parser("run", parents=[kept], help="run a scenario, and record it as a session")
    run.add_argument("file", help="a TOML file, or the name of a scenario that there is")
    run.add_argument(
        "--place",
        choices=("simulated", "live"),
        default="simulated",
        help="in simulated time (default), or on the robot of the server that runs, in real time",
    )
    run.add_argument(
        "--board",
        choices=("host", "emulated"),
        default="host",
        help="in simulated time: the firmware built for this computer (default), or on the emulated board",
    )


def _add_commtest(actions: "Actions", kept: argparse.ArgumentParser) -> None:
    run = actions.add_parser("run", parents=[kept], help="run the tests of a document")
    run.add_argument("file", type=Path, help="the test document, JSON")
    run.add_argument(
        "--place",
        choices=("emulated", "robot"),
        help="boards of its own in emulated time, or the robot's board in real time; default as robot.mode",
    )
    actions.add_parser("list", parents=[kept], help="list the runs that are kept")
    show = actions.add_parser("show", parents=[kept], help="show a run: configuration, rates, reasons")
    show.add_argument("run", type=int, help="its number")
    compare = actions.add_parser("compare", parents=[kept], help="show runs side by side")
    compare.add_argument("runs", nargs="+", help="numbers of runs; table5 and table6 are the thesis's")
    export = actions.add_parser("export", parents=[kept], help="write a run to the standard output")
    export.add_argument("run", type=int, help="its number")
    export.add_argument("--format", choices=("csv", "json"), default="csv", help="default csv")


def _add_report(report: argparse.ArgumentParser) -> None:
    report.add_argument("sessions", nargs="+", type=int, metavar="ID", help="numbers of sessions")
    report.add_argument("-o", "--out", type=Path, default=Path("report.html"), help="default report.html")
    moments = ("start", "armed", "set_point")
    report.add_argument("--align", choices=moments, default="armed", help="what is 0 s; default armed")
    report.add_argument("--step", type=int, default=1, help="which set-point step; default 1")
    report.add_argument("--marker", default="", help="what is 0 s: the marker of this text")
    report.add_argument(
        "--signals", nargs="+", metavar="TOPIC.COLUMN", help="default as the thesis's figures"
    )


def _add_backup(commands: "Actions", kept: argparse.ArgumentParser) -> None:
    backup = commands.add_parser(
        "backup", parents=[kept], help="copy the database, also while a server records"
    )
    backup.add_argument("file", nargs="?", type=Path, help="default a new one in data/backups")
    restore = commands.add_parser("restore", parents=[kept], help="put a copy in the database's place")
    restore.add_argument("file", type=Path, help="what `mucat backup` wrote")


@contextmanager
def _claim(folder: DataFolder) -> Iterator[None]:
    """Hold the data folder alone. Raises SetupError where another server has it.

    Parts of a killed server look now and then whether the lock is held, and then have it for a moment.
    """
    try:
        make_folder(folder.path)
        handle = folder.lock.open("w")
    except OSError as problem:
        raise SetupError(f"The data folder {folder.path} cannot be used: {problem.strerror}.") from problem
    with handle:
        if not _lock(handle):
            runner = runner_of(folder)
            process = f" (process {runner})" if runner is not None else ""
            raise SetupError(
                f"Another server works on {folder.path}{process}. End it, or choose another folder with "
                "--data."
            )
        make_folders(folder)
        yield


def _lock(handle: IO[str]) -> bool:
    for _ in range(LOCK_TRIES):
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            time.sleep(LOCK_SECONDS)
        else:
            return True
    return False


def _commtest(options: argparse.Namespace, settings: Settings) -> int:
    from server.features.comm_tests.command import perform

    return perform(options, settings, _claim)


def _scenario(options: argparse.Namespace, settings: Settings) -> int:
    from server.features.scenarios.command import perform

    return perform(options, settings, _claim)


def _sessions(options: argparse.Namespace, settings: Settings) -> int:
    from server.features.sessions.command import perform

    return perform(options, settings, _claim)


def _access(options: argparse.Namespace, settings: Settings) -> int:
    from server.features.people.command import perform

    return perform(options, settings)


def _report(options: argparse.Namespace, settings: Settings) -> int:
    from server.features.comparison.command import perform

    return perform(options, settings, _claim)


def _carry(options: argparse.Namespace, settings: Settings) -> int:
    from server.features.exports.command import export_session, import_session

    perform = export_session if options.command == "export" else import_session
    return perform(options, settings, _claim)


def _back_up(options: argparse.Namespace, settings: Settings) -> int:
    from server.features.backup.command import perform

    return perform(options, settings, _claim)


def _run(settings: Settings) -> int:
    # Loaded only now: a wrong command line should be told at once, also on a slow computer.
    from robot_runtime.simulation.boards.firmware import BuildError, build_firmware
    from server.app import create_app
    from server.http.serving import make_server, open_socket
    from server.platform.certificate import prepare_certificate
    from server.platform.running_server import announce
    from server.platform.schema import prepare
    from server.processes.supervisor import plan

    if settings.emulated_board:
        try:
            build_firmware(settings.build, settings.link.baud, hil=settings.in_the_loop)
        except BuildError as problem:
            raise SetupError(str(problem)) from problem
    with open_socket(settings.host, settings.port) as listener:
        certificate = prepare_certificate(settings) if settings.tls else None

        def greet(access: "Access") -> None:
            if not app.state.ended:
                _greet(settings, access, certificate)

        app = create_app(settings, plan(settings), greet)
        server = make_server(app, certificate)
        server.config.load()

        def serve(ended: str) -> int:
            """In a process of its own; `ended` says how the server before it did, if there was one."""
            try:
                prepare(settings.data)
            except SetupError as problem:
                return _complain(problem)
            announce(settings)
            # The server ends in order at these, and then sends them to itself once more; once is enough.
            for number in (signal.SIGINT, signal.SIGTERM):
                signal.signal(number, lambda *_: None)
            app.state.ended = ended
            server.run(sockets=[listener])
            return 0

        return ServerRunner(serve, settings.data).run()


def _greet(settings: Settings, access: "Access", certificate: "Certificate | None") -> None:
    from server.features.people.welcome import shows_pictures, welcome

    lines = welcome(settings, access, certificate, picture=shows_pictures(sys.stdout))
    print(*lines, sep="\n", flush=True)  # noqa: T201 - a command line speaks


if __name__ == "__main__":
    sys.exit(main())
