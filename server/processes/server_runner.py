"""Runs the server in a forked child process, and forks the next one when it dies.

Most of a server's start is the loading of its libraries: 2 s here, a minute on a Raspberry Pi Zero. The
runner has loaded them once and never runs a thread, so that a fork of it serves at once. It also holds the
listening socket, at which clients wait meanwhile, and the lock of the data folder.

The runner itself is not supervised. When it is killed, the kernel kills the server with it; the robot's other
processes run on, and the next `mucat run` adopts them. Restarting the runner is the work of systemd.
"""

import gc
import os
import signal
import sys
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import NoReturn

from robot_runtime.transport.lifetime import end_with_parent
from server.platform.pidfile import PidFile
from server.platform.settings import DataFolder
from server.processes.backoff import Backoff, describe_pause, is_killed
from server.processes.exit_status import describe_status

Serve = Callable[[str], int]
"""Serves until the server ends, and returns its exit status. The argument describes the end of the server
before it; "" for the first one."""

_STOPS = (signal.SIGINT, signal.SIGTERM)
_ALL = (*_STOPS, signal.SIGCHLD)


class ServerRunner:
    """Forks servers that call `serve`. Create and `run` it before any thread is started."""

    def __init__(self, serve: Serve, folder: DataFolder) -> None:
        self._serve = serve
        self._file = PidFile(folder.runner)

    def run(self) -> int:
        """Run servers until one ends in order or the first cannot start; returns the exit status."""
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
        backoff, ended = Backoff(), ""
        while True:
            started = time.monotonic()
            status, stopping = _wait(self._fork(ended))
            if stopping or status == 0 or (status > 0 and not ended):
                return max(status, 0)
            ended = f"The server {describe_status(status)}."
            pause = backoff.after(time.monotonic() - started, killed=is_killed(status))
            _say(f"{ended} It is started again {describe_pause(pause)}.")
            if signal.sigtimedwait(_STOPS, pause) is not None:
                return max(status, 0)

    def _fork(self, ended: str) -> int:
        sys.stdout.flush()
        sys.stderr.flush()
        runner = os.getpid()
        pid = os.fork()
        if pid == 0:
            self._become_server(runner, ended)
        return pid

    def _become_server(self, runner: int, ended: str) -> NoReturn:
        status = 1
        try:
            end_with_parent(runner, signal.SIGKILL)
            for number in _STOPS:
                signal.signal(number, signal.SIG_DFL)
            signal.pthread_sigmask(signal.SIG_UNBLOCK, _ALL)
            _set_name("mucat-server")
            status = self._serve(ended)
        except SystemExit as end:
            status = end.code if isinstance(end.code, int) else 1
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(status)


def _wait(server: int) -> tuple[int, bool]:
    """Wait for a server's end. Returns its status, negative for a signal, and true if told to stop."""
    stopping = False
    while True:
        if signal.sigwait(_ALL) in _STOPS:
            stopping = True
            # The server is not reaped yet, so no other process can have its number.
            os.kill(server, signal.SIGTERM)
        ended, status = os.waitpid(server, os.WNOHANG)
        if ended:
            return os.waitstatus_to_exitcode(status), stopping


def _set_name(name: str) -> None:
    """Set the name that `ps` and `top` show for this process; at most 15 characters."""
    with suppress(OSError):
        Path("/proc/self/comm").write_text(name, encoding="ascii")


def _say(text: str) -> None:
    print(f"mucat: {text}", file=sys.stderr, flush=True)  # noqa: T201 - a command line speaks
