"""A process and its process group, watched by the event loop without a thread.

asyncio's own subprocesses count as ended only when their output is closed, which a grandchild can hold open,
and know nothing of processes that somebody else has started.
"""

import asyncio
import os
import select
import subprocess
from collections.abc import Callable, Sequence
from contextlib import suppress
from signal import SIGKILL, Signals
from typing import IO

from server.platform.pidfile import started_at

READ_BYTES = 65_536
KILL_SECONDS = 1.0
"""Within which the kernel ends what is killed."""


class Process:
    """Started at once, in a session and group of its own; what it and its children print goes to `output`.

    It reads `given` on its standard input, and nothing without. Raises OSError where it cannot be started.
    Call it in the event loop's thread, and `close` in the end.
    """

    def __init__(
        self, arguments: Sequence[str], output: IO[bytes] | int, given: IO[bytes] | None = None
    ) -> None:
        self._popen = subprocess.Popen(
            arguments,
            stdin=given or subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            env={**os.environ, "PYTHONUNBUFFERED": "1"},
        )
        self._watched = _ProcessGroup(self._popen.pid, self._reap)

    @property
    def pid(self) -> int:
        """The process's number, also its group's."""
        return self._popen.pid

    async def wait(self) -> int:
        """The exit status; negative for the signal that ended it. What it had started is then ended too."""
        await self._watched.wait()
        status: int = self._popen.returncode
        return status

    def signal(self, number: Signals) -> None:
        """Send a signal to the whole group, where the process still runs."""
        self._watched.signal(number)

    def close(self) -> None:
        """End the group, and release all resources."""
        self._watched.close()

    def _reap(self) -> None:
        self._popen.wait()


class PipedProcess(Process):
    """A process whose `output` is called with what it and its children print."""

    def __init__(
        self, arguments: Sequence[str], output: Callable[[bytes], None], given: IO[bytes] | None = None
    ) -> None:
        self._output = output
        super().__init__(arguments, subprocess.PIPE, given)
        assert self._popen.stdout is not None
        self._pipe = self._popen.stdout.fileno()
        os.set_blocking(self._pipe, False)
        self._loop = asyncio.get_running_loop()
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

    def _reap(self) -> None:
        super()._reap()
        # All of its own output is in the pipe by now, which holds no more than one reading takes.
        self._read()


class AdoptedProcess:
    """A process that another server has started, at a time as `started_at` has it; used as `Process`.

    Raises OSError where it has ended.
    """

    def __init__(self, pid: int, started: int) -> None:
        self.pid = pid
        self._handle = os.pidfd_open(pid)
        if started_at(pid) != started:
            os.close(self._handle)
            raise ProcessLookupError(f"process {pid} is another one by now")
        self._watched = _ProcessGroup(pid, self._wait_killed)

    async def wait(self) -> None:
        """Wait for its end. Its exit status is not available."""
        await self._watched.wait()

    def signal(self, number: Signals) -> None:
        """Send a signal to the whole group, where the process still runs."""
        self._watched.signal(number)

    def close(self) -> None:
        """End the group, and release all resources."""
        self._watched.close()

    def _wait_killed(self) -> None:
        select.select([self._handle], [], [], KILL_SECONDS)
        os.close(self._handle)


class _ProcessGroup:
    """A running process group, by its leader; `reap` is called once, when the leader has ended."""

    def __init__(self, pid: int, reap: Callable[[], None]) -> None:
        self._pid = pid
        self._reap = reap
        self._loop = asyncio.get_running_loop()
        self._ended: asyncio.Future[None] = self._loop.create_future()
        self._handle = os.pidfd_open(pid)
        self._loop.add_reader(self._handle, self._end)

    async def wait(self) -> None:
        """Wait until the process has ended, and with it what it had started."""
        await asyncio.shield(self._ended)

    def signal(self, number: Signals) -> None:
        """Send a signal to the whole group, where the process still runs."""
        if not self._ended.done():
            self._signal_group(number)

    def close(self) -> None:
        """End what still runs, and stop watching."""
        if not self._ended.done():
            self._end()

    def _end(self) -> None:
        # Before the process is reaped its number still belongs to its group alone.
        self._signal_group(SIGKILL)
        self._reap()
        self._loop.remove_reader(self._handle)
        os.close(self._handle)
        self._ended.set_result(None)

    def _signal_group(self, number: Signals) -> None:
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(self._pid, number)


def describe_status(status: int | None) -> str:
    """The end of a process, as words that follow its name; `status` is None where it is unknown."""
    if status is None:
        return "has ended; its exit status is not known, because an earlier server had started it"
    if status >= 0:
        return f"has ended with exit status {status}"
    try:
        name = Signals(-status).name
    except ValueError:
        name = str(-status)
    return f"was ended by signal {name}"
