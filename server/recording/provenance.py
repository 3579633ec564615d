"""Provenance of the robot's behaviour: configuration, firmware and software as they were read."""

import asyncio
import logging
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from robot_runtime.contract.text_input import TextError, load_text
from robot_runtime.errors import RefusedError
from robot_runtime.provenance import hash_firmware, hash_software
from robot_runtime.simulation.boards.firmware import firmware_path
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.stream.bridge import RuntimeSilentError

log = logging.getLogger(__name__)

TRY_AGAIN_SECONDS = 1.0


@dataclass(frozen=True, slots=True)
class Provenance:
    """The text of robot.toml, and the hashes of firmware and software; empty where they are not known."""

    configuration: str
    firmware: str
    software: str


def read_provenance(settings: Settings) -> Provenance:
    """Return the provenance of a present start. It reads files: not for the event loop."""
    try:
        software = hash_software()
    except OSError as problem:
        log.warning("the software's hash is not known: %s", problem)
        software = ""
    return Provenance(settings.config_text, _read_firmware(settings), software)


class ProvenanceWatch:
    """Watch of the provenance in force: it queries each run of the runtime, and reads firmware when loaded.

    Until the runtime has answered, it is the server's own at its start.
    """

    def __init__(
        self, settings: Settings, ask: Callable[[], Awaitable[Mapping[str, Any]]], notices: Notices
    ) -> None:
        self._now = Provenance(settings.config_text, "", "")
        self._opened = asyncio.Event()
        self._settings = settings
        self._ask = ask
        self._notices = notices
        self._run = ""
        self._board: int | None = None
        self._news = asyncio.Event()

    async def open(self) -> None:
        """Read the provenance at the server's start."""
        self._now = await asyncio.to_thread(read_provenance, self._settings)
        self._opened.set()

    async def now(self) -> Provenance:
        """Return the provenance in force; wait until it was opened."""
        await self._opened.wait()
        return self._now

    def see_run(self, run: str) -> None:
        """Store the present run of the runtime."""
        if run != self._run:
            self._run = run
            self._news.set()

    async def see_board(self, pid: int | None) -> None:
        """Store the process of the emulated board, which has loaded the firmware at its start."""
        if pid is not None and pid != self._board:
            if self._board is not None:
                await self.read_firmware()
            self._board = pid

    async def read_firmware(self) -> None:
        """Read the firmware that was just uploaded to the board."""
        firmware = await asyncio.to_thread(_read_firmware, self._settings)
        self._now = replace(self._now, firmware=firmware)

    async def run(self) -> None:
        """Open the watch, and query each run of the runtime, for ever."""
        # Not before the server serves: it takes a slow computer a second.
        await self.open()
        while True:
            await self._news.wait()
            self._news.clear()
            try:
                answer = await self._ask()
            except (RuntimeSilentError, RefusedError):
                await asyncio.sleep(TRY_AGAIN_SECONDS)
                self._news.set()
                continue
            self._take(str(answer["configuration"]), str(answer["software"]))

    def _take(self, configuration: str, software: str) -> None:
        if configuration != self._now.configuration:
            self._notices.notify(
                "configuration",
                "caution",
                f"The robot's runtime has read another {self._settings.config.name} than was in force. "
                "A recording that runs keeps the earlier one.",
            )
        self._now = replace(self._now, configuration=configuration, software=software)

    async def compare_file(self) -> None:
        """Report a configuration file that differs from the configuration in force."""
        try:
            text = await asyncio.to_thread(load_text, self._settings.config)
            problem = "was edited" if text != self._now.configuration else ""
        except TextError:
            problem = "was edited"
        except OSError as cause:
            problem = f"cannot be read now ({cause.strerror})"
        if problem:
            self._notices.notify(
                "configuration",
                "caution",
                f"{self._settings.config.name} {problem} since the robot has started. The recording holds "
                "what is in force. Start the server again to apply the file.",
            )


def _read_firmware(settings: Settings) -> str:
    program = firmware_path(settings.build, settings.link.baud, ".hex", hil=settings.in_the_loop)
    return hash_firmware(program)
