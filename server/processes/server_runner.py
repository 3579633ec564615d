"""The runner of the server: it forks a child process, and the next one when that dies.

Most of a server's start is the loading of its libraries: 2 s here, a minute on a Raspberry Pi Zero. The
runner has loaded them once and never runs a thread, so that a fork of it serves at once. It also holds the
listening socket, at which clients wait meanwhile, and the lock of the data folder.

A server that has served is replaced however it ended, unless it ended in order: a library may call exit(3)
in the middle of a request, with any status. Only where none has served yet, an exit status is the end.

The runner itself is not supervised. When it is killed, the kernel kills the server with it; the robot's other
processes run on, and the next `mucat run` adopts them. Restarting the runner is the work of systemd.
"""

import gc
import mmap
import os
import select
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import NoReturn

from robot_runtime.backoff import Backoff, describe_pause, is_killed
from robot_runtime.transport.lifetime import end_with_parent
from server.platform.pidfile import PidFile
from server.platform.settings import DataFolder
from server.processes.error_output import ErrorOutput
from server.processes.exit_status import describe_end, describe_status
from server.processes.logs import LINES_SHOWN

Serve = Callable[[str, Callable[[], None]], int]
"""Serves until the server ends, and returns its exit status, 0 where it has ended in order. The first
argument describes the end of the server before it; "" for
the first one. The second is called once it serves."""

STARTING, SERVING, DONE = range(3)
"""States of a server: the first until it serves, the last where it has ended in order."""
_STOPS = (signal.SIGINT, signal.SIGTERM)
_ALL = (*_STOPS, signal.SIGCHLD)
SIGNALS_MAX = 1024


class ServerRunner:
    """Runner of forked servers that call `serve`. Create and `run` it before any thread is started."""

    def __init__(self, serve: Serve, folder: DataFolder) -> None:
        self._serve = serve
        self._file = PidFile(folder.runner)
        self._state = mmap.mmap(-1, 1)
        """The state of the server, which it shares with the runner."""

    def run(self) -> int:
        """Run servers until one ends in order or the first cannot start; return the exit status."""
        # Keeps the loaded modules' memory shared with the children: a garbage collection would write to it.
        gc.freeze()
        _set_name("mucat-runner")
        try:
            self._file.write(os.getpid(), "")
        except OSError as problem:
            _say(f"Others cannot see which process this is: {problem}.")
        before = signal.pthread_sigmask(signal.SIG_BLOCK, _ALL)
        try:
            return self._run_servers()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
            self._file.remove()

    def _run_servers(self) -> int:
        backoff, ended, served = Backoff(), "", False
        while True:
            started = time.monotonic()
            status, stopping, last = self._run_server(ended)
            served = served or self._state[0] != STARTING
            if stopping or self._state[0] == DONE:
                return max(status, 0)
            if status >= 0 and not served:
                _say(f"The server {describe_status(status)} before it could serve; the lines above say why.")
                return status or 1
            ended = f"The server {describe_end(status, last)}".removesuffix(".") + "."
            pause = backoff.after(time.monotonic() - started, killed=is_killed(status))
            _say(f"{ended} It is started again {describe_pause(pause)}.")
            if signal.sigtimedwait(_STOPS, pause) is not None:
                return max(status, 0)

    def _run_server(self, ended: str) -> tuple[int, bool, str]:
        """Run a server to its end. Return its status, true if told to stop, and its last output."""
        self._state[0] = STARTING
        with closing(ErrorOutput()) as errors:
            server = self._fork(ended, errors)
            status, stopping = _wait(server, errors)
            return status, stopping, errors.last(LINES_SHOWN)

    def _fork(self, ended: str, errors: ErrorOutput) -> int:
        sys.stdout.flush()
        sys.stderr.flush()
        runner = os.getpid()
        pid = os.fork()
        if pid == 0:
            self._become_server(runner, ended, errors)
        return pid

    def _become_server(self, runner: int, ended: str, errors: ErrorOutput) -> NoReturn:
        status = 1
        try:
            end_with_parent(runner, signal.SIGKILL)
            errors.become()
            for number in _STOPS:
                signal.signal(number, signal.SIG_DFL)
            signal.pthread_sigmask(signal.SIG_UNBLOCK, _ALL)
            _set_name("mucat-server")
            status = self._serve(ended, self._note_serving)
            if status == 0:
                self._state[0] = DONE
        except SystemExit as end:
            status = end.code if isinstance(end.code, int) else 1
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(status)

    def _note_serving(self) -> None:
        self._state[0] = SERVING


def _wait(server: int, errors: ErrorOutput) -> tuple[int, bool]:
    """Wait for a server's end. Return its status, negative for a signal, and true if told to stop."""
    stopping = False
    with _signals() as arrived:
        while True:
            select.select([arrived, errors.handle], [], [])
            errors.pass_on()
            with suppress(BlockingIOError):
                if not stopping and any(number in _STOPS for number in os.read(arrived, SIGNALS_MAX)):
                    stopping = True
                    # The server is not reaped yet, so no other process can have its number.
                    os.kill(server, signal.SIGTERM)
            ended, status = os.waitpid(server, os.WNOHANG)
            if ended:
                errors.pass_on()
                return os.waitstatus_to_exitcode(status), stopping


@contextmanager
def _signals() -> Iterator[int]:
    """Yield a handle from which the numbers of signals can be read as they arrive."""
    arrived, other_end = os.pipe()
    os.set_blocking(arrived, False)
    os.set_blocking(other_end, False)
    handlers = {number: signal.signal(number, lambda *_: None) for number in _ALL}
    signal.set_wakeup_fd(other_end)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _ALL)
    try:
        yield arrived
    finally:
        signal.pthread_sigmask(signal.SIG_BLOCK, _ALL)
        signal.set_wakeup_fd(-1)
        for number, handler in handlers.items():
            signal.signal(number, handler)
        os.close(arrived)
        os.close(other_end)


def _set_name(name: str) -> None:
    """Set the name that `ps` and `top` show for this process; at most 15 characters."""
    with suppress(OSError):
        Path("/proc/self/comm").write_text(name, encoding="ascii")


def _say(text: str) -> None:
    print(f"mucat: {text}", file=sys.stderr, flush=True)  # noqa: T201 - a command line speaks
