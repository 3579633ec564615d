"""A process of ours that answers tasks one after the other, and so spares the server its work.

A task is a line of JSON on its standard input. An answer is a line of JSON on its standard output, {"status",
"bytes"}, and so many bytes: the result, or the reason where the status is not 200.
"""

import asyncio
import json
import sys
from asyncio.subprocess import PIPE, Process
from typing import Any, Self

from server.processes.exit_status import describe_status


class TaskProcessEndedError(Exception):
    """The process ended before it answered; the text says how, after the name of the process."""


class TaskProcess:
    """The server's end of such a process."""

    def __init__(self, process: Process) -> None:
        self._process = process
        self._ending: asyncio.Task[None] | None = None

    @classmethod
    async def start(cls, module: str, *arguments: str) -> Self:
        """Start `python -m MODULE ARGUMENTS`. Raise OSError."""
        command = [sys.executable, "-m", module, *arguments]
        # In a session of its own: a terminal's Ctrl-C is meant for the server, which ends it.
        return cls(
            await asyncio.create_subprocess_exec(*command, stdin=PIPE, stdout=PIPE, start_new_session=True)
        )

    @property
    def pid(self) -> int:
        """The number of the process."""
        return self._process.pid

    @property
    def ended(self) -> bool:
        """True after its end."""
        return self._process.returncode is not None

    async def ask(self, task: Any, seconds: float) -> tuple[int, bytes]:
        """Return status and body of the answer to a task, within `seconds`.

        Raise TimeoutError, TaskProcessEndedError. A process without a whole answer is ended: the next task
        would read its rest.
        """
        try:
            async with asyncio.timeout(seconds):
                return await self._exchange(task)
        except (asyncio.IncompleteReadError, ConnectionError):
            status = await self._process.wait()
            await self.end()
            raise TaskProcessEndedError(describe_status(status)) from None
        except BaseException:
            await self.end()
            raise

    async def end(self) -> None:
        """End the process; whoever asks for it again waits for the same end."""
        if self._ending is None:
            self._ending = asyncio.create_task(self._end())
        await asyncio.shield(self._ending)

    async def _exchange(self, task: Any) -> tuple[int, bytes]:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(json.dumps(task).encode() + b"\n")
        await self._process.stdin.drain()
        head = json.loads(await self._process.stdout.readuntil())
        return head["status"], await self._process.stdout.readexactly(head["bytes"])

    async def _end(self) -> None:
        assert self._process.stdin is not None
        if self._process.returncode is None:
            self._process.kill()
        self._process.stdin.close()
        # `wait` would never return where a pipe is full, and nobody reads it any more.
        await self._process.communicate()


def write_answer(status: int, body: bytes) -> None:
    """Answer a task, in the process."""
    head = json.dumps({"status": status, "bytes": len(body)}).encode()
    sys.stdout.buffer.write(head + b"\n" + body)
    sys.stdout.buffer.flush()
