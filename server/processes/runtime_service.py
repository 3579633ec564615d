"""`mucat runtime`: the robot's runtime as a service of its own, apart from the server."""

import os
import time
from pathlib import Path

import click

from robot_runtime.durable_files import make_folder
from robot_runtime.service_manager import ServiceManager
from robot_runtime.transport.lifetime import is_served
from server.platform.command_line import with_settings
from server.platform.pidfile import hold_still, pid_file, running_parts
from server.platform.settings import DataFolder, Settings, SetupError

WAIT_SECONDS = 0.2
START_SECONDS = 60.0
"""A start after waiting, on a Raspberry Pi Zero; until then systemd's watchdog is as patient."""


@click.command("runtime")
@with_settings
def run_runtime(settings: Settings) -> None:
    """Run the robot's runtime alone; systemd starts this.

    `mucat run --external-runtime` is the server beside it.
    """
    if settings.lab:
        raise SetupError(f"{settings.data.path} is a lab's, which has no robot.")
    from server.processes.supervisor import plan

    (command,) = (candidate for candidate in plan(settings) if candidate.name == "runtime")
    folder = settings.data
    try:
        make_folder(folder.run)
        entered = False
        while not entered:
            _wait_for_turn(folder, command.needs)
            entered = _enter(folder, command.fingerprint())
    except OSError as problem:
        raise SetupError(
            f"The data folder {folder.path} cannot be used: {problem.strerror}. Look at it with mucat doctor."
        ) from problem
    # The same process: systemd and the server know it by its number.
    os.execv(command.arguments[0], command.arguments)


def _enter(folder: DataFolder, fingerprint: str) -> bool:
    """Write this process's PID file as the runtime's; return False where the runtime is paused.

    Raise SetupError where another one runs, OSError.
    """
    file = pid_file(folder.run, "runtime")
    with hold_still(folder.run):
        if "runtime" in running_parts(folder.run):
            raise SetupError(f"A runtime works on {folder.path} already. End it first.")
        folder.runtime_socket.unlink(missing_ok=True)
        file.write(os.getpid(), fingerprint)
    # Whoever pauses it writes the mark before looking for a process to end: one of both sees the other.
    if _is_paused(folder):
        file.remove()
        return False
    return True


def _is_paused(folder: DataFolder) -> bool:
    return folder.runtime_paused.exists() and is_served(folder.lock)


def _wait_for_turn(folder: DataFolder, needs: tuple[Path, ...]) -> None:
    """Wait until the files exist that the runtime needs, and nobody else uses its board."""
    service = ServiceManager()
    while _is_paused(folder) or not all(path.exists() for path in needs):
        service.wait(START_SECONDS)
        time.sleep(WAIT_SECONDS)
