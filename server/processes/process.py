"""A process and its process group, watched by the event loop without a thread.

asyncio's own subprocesses count as ended only when their output is closed, which a grandchild can hold open,
and do not cover processes that somebody else has started.
"""

import asyncio
import os
import select
import subprocess
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from signal import SIGKILL, Signals
from types import MappingProxyType
from typing import IO

from server.platform.pidfile import started_at

READ_BYTES = 65_536
KILL_SECONDS = 1.0
"""The time that the kernel takes at most to end a killed process."""


class ProcessGroup(ABC):
    """A running process and its group, whose number is the same. Used in the event loop's thread only."""

    def __init__(self, pid: int) -> None:
        self.pid = pid
        self._loop = asyncio.get_running_loop()
        self._ended: asyncio.Future[int | None] = self._loop.create_future()
        self._handle = os.pidfd_open(pid)
        self._loop.add_reader(self._handle, self._end)

    async def wait(self) -> int | None:
        """Wait until the process has ended and its group was killed.

        Return the exit status, negative for the signal that ended it; None if it is not available.
        """
        return await asyncio.shield(self._ended)

    def signal(self, number: Signals) -> None:
        """Send a signal to the whole group, if the process still runs."""
        if not self._ended.done():
            self._signal_group(number)

    def close(self) -> None:
        """End the group, and release all resources."""
        if not self._ended.done():
            self._end()

    def leave(self) -> None:
        """Stop watching the process; it runs on."""
        if not self._ended.done():
            self._loop.remove_reader(self._handle)
            os.close(self._handle)
            self._ended.cancel()

    @abstractmethod
    def _reap(self) -> int | None:
        """Return the exit status of the process, which has just ended or been killed."""

    def _end(self) -> None:
        # Before the process is reaped its number still belongs to its group alone.
        self._signal_group(SIGKILL)
        status = self._reap()
        self._loop.remove_reader(self._handle)
        os.close(self._handle)
        self._ended.set_result(status)

    def _signal_group(self, number: Signals) -> None:
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(self.pid, number)


class Process(ProcessGroup):
    """A process started at once, in a session and group of its own; its output goes to `output`.

    `given` is its standard input, if any; `environment` is added to that of this process. Call `close` when
    done with it. Raises OSError if it cannot be started.
    """

    def __init__(
        self,
        arguments: Sequence[str],
        output: IO[bytes] | int,
        given: IO[bytes] | None = None,
        environment: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        self._popen = subprocess.Popen(
            arguments,
            stdin=given or subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            env={**os.environ, "PYTHONUNBUFFERED": "1", **environment},
        )
        super().__init__(self._popen.pid)

    def _reap(self) -> int | None:
        return self._popen.wait()


class PipedProcess(Process):
    """A process whose output, with its children's, goes to the function `output`."""

    def __init__(
        self,
        arguments: Sequence[str],
        output: Callable[[bytes], None],
        given: IO[bytes],
        environment: Mapping[str, str],
    ) -> None:
        self._output = output
        super().__init__(arguments, subprocess.PIPE, given, environment)
        assert self._popen.stdout is not None
        self._pipe = self._popen.stdout.fileno()
        os.set_blocking(self._pipe, False)
        self._loop.add_reader(self._pipe, self._read)

    def close(self) -> None:
        """End the group, and release all resources."""
        super().close()
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

    def _reap(self) -> int | None:
        status = super()._reap()
        # All of its own output is in the pipe by now, which holds no more than one read returns.
        self._read()
        return status


class AdoptedProcess(ProcessGroup):
    """A process that an earlier server has started, at the time `started` (see `started_at`).

    Its exit status is not available. Raises OSError if it has ended.
    """

    def __init__(self, pid: int, started: int) -> None:
        super().__init__(pid)
        if started_at(pid) != started:
            self._loop.remove_reader(self._handle)
            os.close(self._handle)
            raise ProcessLookupError(f"process {pid} has ended; its number belongs to another process now")

    def _reap(self) -> None:
        select.select([self._handle], [], [], KILL_SECONDS)
