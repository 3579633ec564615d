"""The adopted craft: its file in the data folder, and the file that it has replaced."""

import asyncio
from pathlib import Path

from robot_runtime.config import craft_in, parse_text
from robot_runtime.contract.commands import ControllerCommand
from robot_runtime.contract.craft import Craft, load_craft
from robot_runtime.contract.limits import ConfigError
from robot_runtime.control.craft_gains import craft_gains
from robot_runtime.durable_files import sync, write_whole
from robot_runtime.errors import RefusedError
from server.driving.changes import Changes
from server.features.identification.effect import describe_effect
from server.features.identification.schemas import AdoptedCraft
from server.health.monitor import HealthMonitor
from server.platform.disk_space import FileWriteError, explain_write_error
from server.platform.settings import Settings
from server.processes.supervisor import SIMULATION_ELSEWHERE, ProcessSupervisor
from server.stream.bridge import RuntimeSilentError

SIMULATOR = "simulator"
PREDICTIVE = "predictive"


class CraftAdoption:
    """The adoption of a craft for simulator and model-based controller, and its undoing, once."""

    def __init__(
        self, settings: Settings, monitor: HealthMonitor, processes: ProcessSupervisor, changes: Changes
    ) -> None:
        self._settings = settings
        self._monitor = monitor
        self._processes = processes
        self._changes = changes
        self._file = settings.data.craft
        self._before = settings.data.craft_before
        self._turn = asyncio.Lock()

    def describe(self) -> AdoptedCraft:
        """Return the craft in force."""
        file = self._settings.craft_file
        title, origin, problem = "", "", self._obstacle()
        if file.exists():
            try:
                document = load_craft(file)
                title, origin = document.title, document.origin
            except ConfigError as error:
                problem = str(error)
        return AdoptedCraft(
            title=title,
            origin=origin,
            file=str(file) if file.exists() else "",
            can_undo=self._before.exists() and not self._settings.craft.file,
            problem=problem,
        )

    async def adopt(self, text: str, who: str) -> list[str]:
        """Adopt the craft of this file; return the effects as text. Raise RefusedError."""
        async with self._turn:
            return await self._change(text.encode(), who, keep=True)

    async def undo(self, who: str) -> list[str]:
        """Restore the craft before the last adoption. Raise RefusedError."""
        async with self._turn:
            if not self._before.exists():
                raise RefusedError("There is no adoption to undo.")
            return await self._change(await asyncio.to_thread(self._before.read_bytes), who, keep=False)

    def _obstacle(self) -> str:
        """Return the reason why no craft can be adopted now; empty if there is none."""
        if self._settings.craft.file:
            named = self._settings.craft_file
            return f"robot.toml names the craft file {named}. Remove that entry, or edit the file."
        if (self._monitor.state() or {}).get("armed"):
            return "The robot is armed. Disarm it first."
        return ""

    async def _change(self, text: bytes, who: str, *, keep: bool) -> list[str]:
        """Write the file, or remove it where `text` is empty; an empty file before it stands for none."""
        if reason := self._obstacle():
            raise RefusedError(reason)
        old = await asyncio.to_thread(self._read, self._file)
        if keep and await asyncio.to_thread(self._has, text):
            # The craft before it must stay the one that an undoing restores.
            return describe_effect(old, old)
        try:
            await asyncio.to_thread(self._write, text, keep)
        except OSError as problem:
            raise FileWriteError(explain_write_error(problem, self._file)) from problem
        new = await asyncio.to_thread(self._read, self._file)
        return [*describe_effect(old, new), *await self._restart_simulator(), *await self._tune(new, who)]

    def _read(self, path: Path) -> Craft:
        try:
            return craft_in(path)
        except ConfigError:
            return Craft()  # it was edited by hand, and is replaced

    def _has(self, text: bytes) -> bool:
        return self._file.exists() and self._file.read_bytes() == text

    def _write(self, text: bytes, keep: bool) -> None:
        if keep:
            write_whole(self._before, self._file.read_bytes() if self._file.exists() else b"")
        if text:
            write_whole(self._file, text)
        else:
            self._file.unlink(missing_ok=True)
        if not keep:
            self._before.unlink()
        sync(self._file.parent)

    async def _restart_simulator(self) -> list[str]:
        """Restart the simulator with the new craft, if it runs here."""
        simulator = self._processes.get(SIMULATOR)
        if simulator is None:
            return []
        if simulator.state == "paused" and simulator.problem != SIMULATION_ELSEWHERE:
            # As during a bring-up: it starts with this craft afterwards.
            return []
        if simulator.state == "paused":
            return ["The simulator on another computer must be started again with this craft file (--craft)."]
        await self._processes.pause(SIMULATOR, "It is started again with another craft.")
        self._processes.resume(SIMULATOR)
        return ["The simulator was started again; the robot floats at its start."]

    async def _tune(self, craft: Craft, who: str) -> list[str]:
        """Set the gains of the running model-based controller that robot.toml leaves to the craft."""
        try:
            configured = parse_text(self._settings.config_text, self._settings.config)
            given = configured.control.gains.get(PREDICTIVE, {})
            if gains := {name: value for name, value in craft_gains(craft).items() if name not in given}:
                await self._changes.command(who, ControllerCommand(name=PREDICTIVE, gains=gains))
        except (RefusedError, RuntimeSilentError) as problem:
            return [f"The model-based controller takes its gains at the next start ({problem})."]
        return []
