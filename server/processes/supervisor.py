"""The supervisor of the robot's processes: it starts them in order, restarts them and ends them.

Each process runs in a session of its own, so that Ctrl-C reaches the server alone and no child outlives the
process. It writes its log itself and does not depend on the server: when the server is killed, the robot goes
on, and the next server adopts the processes that it would start in the same way. Without a next server they
end by themselves (`robot_runtime.transport.lifetime`), except a real robot's runtime.
"""

import asyncio
import sys
from collections.abc import Sequence
from pathlib import Path

from robot_runtime.clock import Clock
from robot_runtime.errors import RefusedError
from robot_runtime.simulation.boards.firmware import firmware_path
from server.platform.pidfile import end_parts
from server.platform.settings import DataFolder, Settings
from server.processes.external_process import ExternalProcess
from server.processes.logs import ProcessLog
from server.processes.managed_process import ManagedProcess, ProcessCommand, SeeDown

HEARTBEAT_SECONDS = 4.0
"""Silence of the server after which the runtime stops the robot. It notices half a second later at most; the
limit is 5 s."""

SIMULATION = ("simulator", "scene")
"""Processes that may run on another computer."""
SIMULATION_ELSEWHERE = "It is left to another computer: mucat simulator --connect ENDPOINT ..."


class ProcessSupervisor:
    """The robot's processes, by name."""

    def __init__(
        self, commands: Sequence[ProcessCommand], folder: DataFolder, clock: Clock, see_down: SeeDown
    ) -> None:
        self._run = folder.run
        self._processes = {command.name: _supervise(command, folder, clock, see_down) for command in commands}
        self._tasks: dict[str, asyncio.Task[None]] = {}

    async def end_others(self) -> None:
        """End processes of a killed server that this one does not use, such as another mode's."""
        await asyncio.to_thread(end_parts, self._run, self._processes)

    def start(self) -> None:
        """Start every process that is not paused, each as soon as the files that it needs exist."""
        for name, part in self._processes.items():
            if part.state != "paused":
                self._tasks[name] = asyncio.create_task(part.run())

    async def stop(self) -> None:
        """End every process, also those of a killed server, and wait for their end."""
        tasks = self._tasks.values()
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        await asyncio.gather(*(part.end() for part in self._processes.values()))

    async def pause(self, name: str, why: str) -> None:
        """End a process until it is resumed; `why` is a sentence for a person.

        Raise RefusedError where a process that systemd starts cannot be paused: it is watched as before.
        """
        task = self._tasks.pop(name, None)
        if task is not None:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
        part = self._processes.get(name)
        if part is None:
            return
        try:
            await part.pause(why)
        except RefusedError:
            if task is not None:
                self._tasks[name] = asyncio.create_task(part.run())
            raise

    def resume(self, name: str) -> None:
        """Start a paused process again."""
        part = self._processes.get(name)
        if part is not None and part.state == "paused":
            self._tasks[name] = asyncio.create_task(part.run())

    def get(self, name: str) -> ManagedProcess | None:
        """Return the process of this name; None where this robot has none."""
        return self._processes.get(name)


def _supervise(
    command: ProcessCommand, folder: DataFolder, clock: Clock, see_down: SeeDown
) -> ManagedProcess:
    output = ProcessLog(folder.logs / f"{command.name}.log")
    if command.external:
        return ExternalProcess(command, folder.run, folder.runtime_paused, clock, see_down, output)
    return ManagedProcess(command, output, folder.run, clock, see_down)


def plan(settings: Settings) -> list[ProcessCommand]:
    """Return the commands of this robot's processes, each after those that it needs; of a lab none."""
    if settings.lab:
        return []
    folder, build = settings.data, settings.build
    runtime = [sys.executable, "-m", "robot_runtime", "--config", str(settings.config)]
    runtime += ["--data", str(folder.path), "--heartbeat", f"{HEARTBEAT_SECONDS:g}"]
    if settings.robot.mode == "robot":
        # Without --server-lock it outlives the server: it must go on controlling a robot under water.
        return [_plan_runtime(settings, runtime)]
    lock = ("--server-lock", str(folder.lock))
    simulator = [sys.executable, "-m", "robot_runtime.simulation"]
    if settings.in_the_loop:
        simulator += ["--in-the-loop", "--connect", f"unixsock-stream/{folder.runtime_socket}"]
    else:
        simulator += ["--board", str(folder.board_socket)]
        for socket in (folder.runtime_socket, folder.server_socket, folder.scene_socket):
            simulator += ["--connect", f"unixsock-stream/{socket}"]
    simulator += ["--robot", settings.robot.name, "--craft", str(settings.craft_file), *lock]
    needs = (folder.runtime_socket,) if settings.in_the_loop else (folder.board_socket, folder.runtime_socket)
    water = ProcessCommand("simulator", "simulator", tuple(simulator), needs, (settings.craft_file,))
    scene = [sys.executable, "-m", "robot_runtime.simulation.scene"]
    scene += ["--listen", f"unixsock-stream/{folder.scene_socket}"]
    for socket in (folder.runtime_socket, folder.server_socket):
        scene += ["--connect", f"unixsock-stream/{socket}"]
    scene += ["--robot", settings.robot.name, *lock]
    sight = ProcessCommand("scene", "simulated scene", tuple(scene), (folder.runtime_socket,))
    if not settings.emulated_board:
        return [
            _plan_runtime(settings, runtime),
            water,
            sight,
        ]
    runtime += ["--port", str(folder.board_tty), *lock]
    program = build / "board"
    elf = firmware_path(build, settings.link.baud, ".elf", hil=settings.in_the_loop)
    # The communication test uploads its sketches to this board, as to a real one.
    bootloader = build / "firmware" / "optiboot.hex"
    board = [str(program), "--elf", str(elf), "--bootloader", str(bootloader)]
    board += ["--tty", str(folder.board_tty), "--socket", str(folder.board_socket)]
    board += ["--eeprom", str(folder.board_eeprom), *lock]
    board += ["--uncalibrated"] if settings.uncalibrated else []
    board += [word for mistake in settings.mistakes for word in ("--mistake", mistake)]
    return [
        ProcessCommand("board", "emulated board", tuple(board), made_of=(program, elf, bootloader)),
        _plan_runtime(settings, runtime, folder.board_tty),
        water,
        sight,
    ]


def _plan_runtime(settings: Settings, arguments: list[str], *needs: Path) -> ProcessCommand:
    files = (settings.config, settings.craft_file, *sorted(settings.data.zenoh.rglob("*.pem")))
    return ProcessCommand(
        "runtime", "robot's runtime", tuple(arguments), needs, files, settings.external_runtime
    )
