"""Keeps the server itself running: a small process that forks it, and forks the next one when it dies.

Most of a server's start is the loading of its libraries: 2 s here, a minute on a Raspberry Pi Zero. The
keeper has loaded them once and never runs a thread, so that a fork of it serves at once. It also holds the
listening socket, at which clients wait meanwhile, and the lock of the data folder.

A *second*, forked as well, does nothing but wait for the keeper's death. Then it keeps the server that there
is, and forks a second of its own. So each of the three may be killed, and the others replace it.
"""

import gc
import importlib
import mmap
import os
import select
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from struct import Struct
from typing import NoReturn

from robot_runtime.transport.lifetime import is_served
from server.platform.pidfile import PidFile
from server.platform.settings import DataFolder
from server.processes.backoff import Backoff, describe_pause
from server.processes.process import describe_status, started_at

Serve = Callable[[str], int]
"""Serves to the end; is told how the server before it ended, "" where it is the first. The exit status."""

GIVE_WAY = signal.SIGUSR1
_ORDERS = (signal.SIGINT, signal.SIGTERM, GIVE_WAY)
_KEPT, _LEFT = "kept", "left"
"""In the keeper's file: whether it is the one that somebody started, or the second of one that was killed."""
_GIVE_WAY_SECONDS = 3.0
_LOOK_SECONDS = 0.02


class Keeper:
    """Forks servers that run `serve`. Make and `run` it before there is any thread."""

    def __init__(self, serve: Serve, folder: DataFolder) -> None:
        self._serve = serve
        self._file = PidFile(folder.keeper)
        self._common = _Common()
        self._backoff = Backoff()
        self._server: int | None = None
        self._second: int | None = None
        self._since = self._due = time.monotonic()
        self._is_first = True
        self._ended = ""
        self._ending = False

    def run(self) -> int:
        """Keep a server running until one ends in order, or the first cannot start. Its exit status."""
        # What is loaded stays shared with the children: collecting garbage would write to all of it.
        gc.freeze()
        return self._keep(_KEPT)

    def _keep(self, how: str) -> int:
        self._file.write(os.getpid(), how)
        _name("mucat-keeper")
        orders = _listen()
        try:
            while True:
                if self._second is None:
                    self._second = self._fork_second()
                if self._server is None and time.monotonic() >= self._due:
                    self._server = self._fork_server()
                self._wait(orders)
                for number in _read(orders):
                    self._obey(number)
                if self._server is not None and _has_ended(self._server):
                    self._see_end(_bury(self._server))
                    self._server = None
                if self._second is not None and _has_ended(self._second):
                    _bury(self._second)
                    self._second = None
                if self._server is None and (self._ending or self._is_over()):
                    return max(self._common.status, 0)
        finally:
            self._end_second()
            self._file.remove()

    def _wait(self, orders: int) -> None:
        poll = select.poll()
        for handle in (orders, self._server, self._second):
            if handle is not None:
                poll.register(handle, select.POLLIN)
        left = None if self._server is not None else 1000 * max(self._due - time.monotonic(), 0.0)
        poll.poll(left)

    def _obey(self, number: int) -> None:
        self._ending = True
        if self._server is not None:
            # One that is killed leaves the robot as it is, for the server that comes.
            _send(self._server, signal.SIGKILL if number == GIVE_WAY else signal.SIGTERM)

    def _see_end(self, status: int | None) -> None:
        now = time.monotonic()
        pause = self._backoff.after(now - self._since, killed=status is None or status < 0)
        self._due = now + pause
        if not self._ending and not self._is_over():
            self._ended = f"The server {'has ended' if status is None else describe_status(status)}."
            _say(f"{self._ended} It is started again {describe_pause(pause)}.")

    def _is_over(self) -> bool:
        status = self._common.status
        return status == 0 or (status > 0 and self._is_first)

    def _fork_server(self) -> int:
        self._is_first = not self._ended
        self._since = time.monotonic()
        self._common.clear()
        keeper = os.getpid()
        pid = _fork(signal.SIG_DFL)
        if pid == 0:
            self._be_server(keeper)
        return os.pidfd_open(pid)

    def _be_server(self, keeper: int) -> NoReturn:
        self._common.write_server()
        if os.getppid() != keeper:
            # Killed meanwhile, and its second may have seen no server yet.
            os._exit(1)
        status = 1
        try:
            _name("mucat-server")
            status = self._serve(self._ended)
        except SystemExit as end:
            status = end.code if isinstance(end.code, int) else 1
        except BaseException:
            traceback.print_exc()
        finally:
            self._common.status = status
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(status)

    def _fork_second(self) -> int:
        keeper = os.pidfd_open(os.getpid())
        pid = _fork(signal.SIG_IGN)
        if pid == 0:
            self._be_second(keeper)
        os.close(keeper)
        return os.pidfd_open(pid)

    def _be_second(self, keeper: int) -> NoReturn:
        _name("mucat-second")
        select.select([keeper], [], [])
        os.close(keeper)
        status = 0
        try:
            if self._common.status != 0:
                status = self._succeed()
        finally:
            # Never back into what the keeper was about to do.
            os._exit(status)

    def _succeed(self) -> int:
        """The keeper was killed: keep the server that there is."""
        self._server, self._second = self._common.open_server(), None
        self._since = self._due = time.monotonic()
        self._ended = self._ended or "The server has ended."
        self._is_first = False
        _say(
            f"The keeper of the server was killed; process {os.getpid()} keeps it from now on. The next "
            "`mucat run` for this data folder takes its place."
        )
        return self._keep(_LEFT)

    def _end_second(self) -> None:
        if self._second is not None:
            _send(self._second, signal.SIGKILL)
            _bury(self._second)


class _Common:
    """Memory that the keeper shares with its children: which process serves, and how it has ended."""

    _SERVER = Struct("<qq")
    _STATUS = Struct("<q")
    _NONE = -1

    def __init__(self) -> None:
        self._memory = mmap.mmap(-1, self._SERVER.size + self._STATUS.size)
        self.clear()

    def clear(self) -> None:
        """No server has started yet."""
        self._SERVER.pack_into(self._memory, 0, 0, 0)
        self.status = self._NONE

    def write_server(self) -> None:
        """This process is the server."""
        pid = os.getpid()
        self._SERVER.pack_into(self._memory, 0, pid, started_at(pid) or 0)

    def open_server(self) -> int | None:
        """A handle of the server's process; None where it does not run."""
        pid, started = self._SERVER.unpack_from(self._memory)
        if pid == 0:
            return None
        try:
            handle = os.pidfd_open(pid)
        except OSError:
            return None
        if started_at(pid) != started:
            os.close(handle)
            return None
        return handle

    @property
    def status(self) -> int:
        """The exit status with which the server has ended by itself; below 0 where it has not."""
        status: int = self._STATUS.unpack_from(self._memory, self._SERVER.size)[0]
        return status

    @status.setter
    def status(self, status: int) -> None:
        self._STATUS.pack_into(self._memory, self._SERVER.size, status)


def keeper_of(folder: DataFolder) -> int | None:
    """The process that keeps the server of this folder; None where none does."""
    running = PidFile(folder.keeper).read()
    return None if running is None else running.pid


def relieve(folder: DataFolder) -> None:
    """End the server of a `mucat run` that was killed, and only that; its parts are left to be adopted."""
    left = PidFile(folder.keeper).read()
    if left is None or left.made != _LEFT:
        return
    # What takes long comes first, so that the robot is without a server for a moment only.
    importlib.import_module("server.app")
    with suppress(ProcessLookupError):
        os.kill(left.pid, GIVE_WAY)
    end = time.monotonic() + _GIVE_WAY_SECONDS
    while is_served(folder.lock) and time.monotonic() < end:
        time.sleep(_LOOK_SECONDS)


def _fork(orders: signal.Handlers) -> int:
    """As fork(2); the child does with the keeper's orders as told here."""
    sys.stdout.flush()
    sys.stderr.flush()
    with _held_back():
        pid = os.fork()
        if pid == 0:
            signal.set_wakeup_fd(-1)
            for number in _ORDERS:
                signal.signal(number, orders)
    return pid


@contextmanager
def _held_back() -> Iterator[None]:
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _ORDERS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _listen() -> int:
    """From now on orders can be read from here, a byte each."""
    ours, pythons = os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC)
    signal.set_wakeup_fd(pythons)
    for number in _ORDERS:
        signal.signal(number, lambda *_: None)
    return ours


def _read(orders: int) -> bytes:
    try:
        return os.read(orders, 64)
    except BlockingIOError:
        return b""


def _send(handle: int, number: signal.Signals) -> None:
    with suppress(ProcessLookupError):
        signal.pidfd_send_signal(handle, number)


def _has_ended(handle: int) -> bool:
    return bool(select.select([handle], [], [], 0)[0])


def _bury(handle: int) -> int | None:
    """Wait for the end. The exit status, negative for a signal; None of a process that another one forked."""
    try:
        ended = os.waitid(os.P_PIDFD, handle, os.WEXITED)
    except ChildProcessError:
        return None
    finally:
        os.close(handle)
    assert ended is not None
    return ended.si_status if ended.si_code == os.CLD_EXITED else -ended.si_status


def _name(name: str) -> None:
    """What `ps` and `top` call this process; at most 15 characters."""
    with suppress(OSError):
        Path("/proc/self/comm").write_text(name, encoding="ascii")


def _say(text: str) -> None:
    print(f"mucat: {text}", file=sys.stderr, flush=True)  # noqa: T201 - a command line speaks
