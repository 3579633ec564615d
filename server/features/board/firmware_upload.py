"""The upload of firmware to the robot's board: the previous firmware is stored, the new one verified."""

import asyncio
import re
from collections.abc import Callable
from contextlib import AbstractAsyncContextManager, suppress
from datetime import UTC, datetime
from pathlib import Path

from robot_runtime.errors import RefusedError
from robot_runtime.places import FIRMWARE_REMEDY
from server.board_reservation import RobotBoard
from server.features.board.previous_firmware import HexFileError, store_if_other
from server.features.board.schemas import PreviousFirmware, UploadChoice, UploadPhase, UploadState
from server.platform.settings import Settings

Reserve = Callable[[str, Path | None], AbstractAsyncContextManager[list[str]]]
_MARKS = 50
"""Characters of avrdude's bar."""


class FirmwareUpload:
    """One upload at a time; `reserve` reserves the board and gives it the program at its end."""

    def __init__(self, settings: Settings, board: RobotBoard, reserve: Reserve) -> None:
        self._data = settings.data
        self._board = board
        self._reserve = reserve
        self._phase: UploadPhase = "idle"
        self._state_text = ""
        self._problem = ""
        self._task: asyncio.Task[None] | None = None

    async def begin(self, choice: UploadChoice) -> None:
        """Begin; `state` returns the progress. Raise RefusedError where it cannot begin."""
        if self._task is not None and not self._task.done():
            raise RefusedError("Firmware is being uploaded. Wait for its end.")
        if not self._board.built.exists():
            raise RefusedError(f"There is no {self._board.built}; {FIRMWARE_REMEDY}.")
        if choice == "previous" and not self._data.firmware_previous.exists():
            raise RefusedError("There is no previous firmware: nothing was replaced yet.")
        reserved: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._task = asyncio.create_task(self._run(choice, reserved))
        await asyncio.shield(reserved)

    async def close(self) -> None:
        """Wait for the end of an upload: half a firmware does not run."""
        if self._task is not None:
            await asyncio.wait([self._task])

    def state(self) -> UploadState:
        """Return the state for the pages."""
        return UploadState(
            phase=self._phase,
            progress=self._progress(),
            words=self._state_text,
            problem=self._problem,
            previous=self._describe_previous(),
        )

    async def _run(self, choice: UploadChoice, reserved: "asyncio.Future[None]") -> None:
        self._state_text = self._problem = ""
        program = self._data.firmware_previous if choice == "previous" else None
        try:
            async with self._reserve("The upload of firmware", program):
                reserved.set_result(None)
                if choice == "built":
                    self._enter("reading")
                    await self._store_previous()
                self._enter("uploading")
            if self._board.problem:
                self._problem = self._board.problem
            else:
                name = "The previous firmware" if choice == "previous" else "The robot's firmware"
                self._state_text = (
                    f"{name} is on the board, read back and compared. {self._state_text}".strip()
                )
        except RefusedError as problem:
            if reserved.done():
                self._problem = str(problem)
            else:
                reserved.set_exception(problem)
        finally:
            self._phase = "idle"
            if not reserved.done():
                reserved.set_exception(RefusedError("The upload ended before it began."))

    def _enter(self, phase: UploadPhase) -> None:
        self._data.upload_progress.unlink(missing_ok=True)
        self._phase = phase

    async def _store_previous(self) -> None:
        self._state_text = await store_previous(self._board, self._data.run, self._data.firmware_previous)

    def _progress(self) -> float:
        if self._phase == "idle":
            return 0.0
        output = ""
        with suppress(OSError):
            output = self._data.upload_progress.read_text(encoding="utf-8", errors="replace")
        return read_progress(output, verified=self._phase == "uploading")

    def _describe_previous(self) -> PreviousFirmware | None:
        try:
            status = self._data.firmware_previous.stat()
        except FileNotFoundError:
            return None
        since = datetime.fromtimestamp(status.st_mtime, UTC)
        return PreviousFirmware(path=str(self._data.firmware_previous), since=since)


async def store_previous(board: RobotBoard, folder: Path, previous: Path) -> str:
    """Store the board's firmware, with unfinished files in `folder`; return the outcome as text."""
    read = folder / "firmware-read.hex"
    if problem := await board.read_out(read):
        return f"The firmware before it could not be read, so it is not stored: {problem}."
    try:
        content = await asyncio.to_thread(store_if_other, read, board.built, previous)
    except (HexFileError, OSError) as problem:
        return f"The firmware before it is not stored: {problem}."
    finally:
        read.unlink(missing_ok=True)
    if content == "other":
        return f"The firmware before it is stored as {previous}."
    return "The same was on it before." if content == "same" else "No firmware was on it before."


def read_progress(output: str, *, verified: bool) -> float:
    """Return avrdude's progress, 0 to 1, by its output; with `verified` it writes and reads back."""
    bars = [(name, len(marks)) for name, marks in re.findall(r"(Writing|Reading) \| (#*)", output)]
    if not bars:
        return 0.0
    name, marks = bars[-1]
    share = min(1.0, marks / _MARKS)
    if not verified:
        return share
    return share / 2 if name == "Writing" else 0.5 + share / 2
