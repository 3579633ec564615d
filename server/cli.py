"""`mucat`: the command line."""

import argparse
import fcntl
import logging
import os
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from server import VERSION
from server.sessions_options import add_record, add_sessions
from server.settings import DataFolder, Settings, SetupError, make_folders, read_settings

if TYPE_CHECKING:
    Actions = argparse._SubParsersAction[argparse.ArgumentParser]


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit status: 0 after an orderly end, 1 where what was asked cannot be done."""
    options = _options(arguments)
    logging.basicConfig(level=logging.WARNING, format="%(asctime)s %(levelname)s %(name)s: %(message)s")
    try:
        settings = read_settings(options.config, options.data, options.host, options.port, os.environ)
        if options.command == "commtest":
            return _commtest(options, settings)
        if options.command in ("sessions", "record"):
            return _sessions(options, settings)
        with _claim(settings.data):
            return _run(settings)
    except SetupError as problem:
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
    sessions = commands.add_parser("sessions", help="find sessions, write about them, delete them")
    add_sessions(sessions.add_subparsers(dest="action", required=True), kept)
    record = commands.add_parser("record", help="record with the running server")
    add_record(record.add_subparsers(dest="action", required=True), kept)
    return parser.parse_args(arguments)


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


@contextmanager
def _claim(folder: DataFolder) -> Iterator[None]:
    """Hold the data folder alone. Raises SetupError where another server has it."""
    try:
        folder.path.mkdir(parents=True, exist_ok=True)
        handle = folder.lock.open("w")
    except OSError as problem:
        raise SetupError(f"The data folder {folder.path} cannot be used: {problem.strerror}.") from problem
    with handle:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as problem:
            raise SetupError(
                f"Another server works on {folder.path}. End it, or choose another folder with --data."
            ) from problem
        make_folders(folder)
        yield


def _commtest(options: argparse.Namespace, settings: Settings) -> int:
    from server.comm_tests.command import perform

    return perform(options, settings, _claim)


def _sessions(options: argparse.Namespace, settings: Settings) -> int:
    from server.sessions_command import perform

    return perform(options, settings, _claim)


def _run(settings: Settings) -> int:
    # Loaded only now: a wrong command line should be told at once, also on a slow computer.
    from robot_runtime.firmware import BuildError, build_firmware
    from server.app import create_app
    from server.parts import plan
    from server.schema import prepare
    from server.web import make_server, open_socket

    if settings.mode == "emulated":
        try:
            build_firmware(settings.build, settings.link.baud)
        except BuildError as problem:
            raise SetupError(str(problem)) from problem
    with open_socket(settings.host, settings.port) as listener:
        prepare(settings.data)
        settings.data.port.write_text(f"{settings.port}\n", encoding="ascii")
        server = make_server(create_app(settings, plan(settings)))
        # The server ends in order at these, and then sends them to itself once more; once is enough.
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda *_: None)
        address = f"[{settings.host}]" if ":" in settings.host else settings.host
        told = f"µ-CAT {VERSION} ({settings.mode}): http://{address}:{settings.port}/"
        print(f"{told} (data in {settings.data.path})", flush=True)  # noqa: T201 - a command line speaks
        server.run(sockets=[listener])
    return 0


if __name__ == "__main__":
    sys.exit(main())
