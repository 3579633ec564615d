"""One child process and its process group, watched by the event loop without a thread.

asyncio's own subprocesses count as ended only when their output is closed, which a grandchild can hold open.
"""

import asyncio
import os
import subprocess
from collections.abc import Callable, Sequence
from contextlib import suppress
from signal import SIGKILL, Signals
from typing import IO

READ_BYTES = 65_536


class Process:
    """Started at once, in a group of its own; `output` is called with what it and its children print.

    It reads `given` on its standard input, and nothing without. Raises OSError where it cannot be started.
    Call it in the event loop's thread, and `close` in the end.
    """

    def __init__(
        self, arguments: Sequence[str], output: Callable[[bytes], None], given: IO[bytes] | None = None
    ) -> None:
        self._output = output
        self._loop = asyncio.get_running_loop()
        self._popen = subprocess.Popen(
            arguments,
            stdin=given or subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            env={**os.environ, "PYTHONUNBUFFERED": "1"},
        )
        assert self._popen.stdout is not None
        self._pipe = self._popen.stdout.fileno()
        os.set_blocking(self._pipe, False)
        self._status: asyncio.Future[int] = self._loop.create_future()
        self._handle = os.pidfd_open(self._popen.pid)
        self._loop.add_reader(self._pipe, self._read)
        self._loop.add_reader(self._handle, self._end)

    @property
    def pid(self) -> int:
        """The process's number, also its group's."""
        return self._popen.pid

    async def wait(self) -> int:
        """The exit status; negative for the signal that ended it. What it had started is then ended too."""
        return await asyncio.shield(self._status)

    def signal(self, number: Signals) -> None:
        """Send a signal to the whole group, where the process still runs."""
        if not self._status.done():
            self._signal_group(number)

    def close(self) -> None:
        """End what still runs, and let go of everything."""
        if not self._status.done():
            self._signal_group(SIGKILL)
            self._popen.wait()
            self._finish()
        self._loop.remove_reader(self._pipe)
        assert self._popen.stdout is not None
        self._popen.stdout.close()

    def _read(self) -> None:
        with suppress(BlockingIOError):
            data = os.read(self._pipe, READ_BYTES)
            if data:
                self._output(data)
            else:
                self._loop.remove_reader(self._pipe)

    def _end(self) -> None:
        # Before the process is reaped its number still belongs to its group alone.
        self._signal_group(SIGKILL)
        self._popen.wait()
        self._finish()

    def _finish(self) -> None:
        self._loop.remove_reader(self._handle)
        os.close(self._handle)
        # All of its own output is in the pipe by now, which holds no more than one reading takes.
        self._read()
        self._status.set_result(self._popen.returncode)

    def _signal_group(self, number: Signals) -> None:
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(self._popen.pid, number)
