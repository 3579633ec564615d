"""Lifetime of a process: it ends with its parent, or when no server is left."""

import argparse
import ctypes
import fcntl
import os
import resource
import signal
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

from robot_runtime.clock import Clock, SteadyClock

HEARTBEAT = "heartbeat"
"""The topic of a server's heartbeat, every second from its main loop: the number of operators' live sockets,
and of the programs that have control, as "1 0"."""
LINGER_SECONDS = 30.0
_PR_SET_PDEATHSIG = 1
_CHECK_SECONDS = 1.0
_STACK_BYTES = 1_048_576
"""Of a thread; the kernel's default is 8 MB, and the runtime has forty threads."""
_AUTOGROUP = Path("/proc/self/autogroup")
_TRIES, _AGAIN = 20, 0.1
"""s. The kernel takes one change in that time from all who are not root."""
_PROCESSOR_BYTES = 20_000_000
"""Room for the stacks, of 8 MB each, of the threads that libraries start for a processor."""


def end_with_parent(parent: int | None = None, number: signal.Signals = signal.SIGTERM) -> None:
    """Have the kernel send a signal to this process when its parent ends (Linux, prctl(2)).

    The parent's thread counts, not only its process: start children from a thread that lives as long.
    `parent` is its process, where that is known from before the fork.
    """
    if parent is None:
        parent = os.getppid()
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.prctl(_PR_SET_PDEATHSIG, number) != 0:
        raise OSError(ctypes.get_errno(), "prctl(PR_SET_PDEATHSIG) failed")
    if os.getppid() != parent:
        sys.exit(0)


def limit_process(memory: int, seconds: int) -> None:
    """Limit this process: bytes of its own memory as `limit_memory`, and s on a processor.

    Beyond the second the kernel ends the process.
    """
    limit_memory(memory)
    resource.setrlimit(resource.RLIMIT_CPU, (seconds,) * 2)


def limit_memory(memory: int, share: float = 0.5) -> None:
    """Limit this process: bytes of its own memory, at most this share of the computer's.

    Beyond that an allocation raises MemoryError. Processes that it starts inherit the limit, and may set
    another. The stacks of threads count whole, so that those of later threads are made small; NumPy and
    OpenCV have threads of their own for each processor, for which there is room in addition.
    """
    threading.stack_size(_STACK_BYTES)
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    room = memory + _PROCESSOR_BYTES * (os.cpu_count() or 1)
    limit = int(min(room, share * memory_bytes()))
    if hard != resource.RLIM_INFINITY:
        limit = min(limit, hard)
    resource.setrlimit(resource.RLIMIT_DATA, (limit, hard))


def limit_library_threads() -> None:
    """Have libraries compute in the calling thread alone, in this process and those that it starts.

    OpenBLAS, which NumPy loads, takes memory for each thread, and ends the process where it gets none.
    """
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ.setdefault(name, "1")


def give_way(niceness: int) -> None:
    """Give this process at least this niceness, also where it inherits one already, and its session, too.

    Without control groups Linux shares the processors between sessions, and only within one by niceness
    (sched(7), "The autogroup feature"). A session that another process leads stays as it is.
    """
    os.setpriority(os.PRIO_PROCESS, 0, max(niceness, os.getpriority(os.PRIO_PROCESS, 0)))
    if os.getsid(0) != os.getpid():
        return
    for _ in range(_TRIES):
        try:
            _AUTOGROUP.write_text(str(niceness), "ascii")
        except BlockingIOError:
            time.sleep(_AGAIN)
        except OSError:
            # This kernel does not share by session.
            return
        else:
            return


def memory_bytes() -> int:
    """Return the computer's memory."""
    return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


def add_server_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of a process that a server starts, and that may outlive it."""
    parser.add_argument("--with-parent", action="store_true", help="end when the parent process ends")
    parser.add_argument("--server-lock", type=Path, help="end when no server has held this file's lock ...")
    parser.add_argument(
        "--linger",
        type=float,
        default=LINGER_SECONDS,
        metavar="SECONDS",
        help=f"... for so long; default {LINGER_SECONDS:g}",
    )


def is_served(lock: Path) -> bool:
    """Return True if a server holds this lock (flock(2)); without the file none can come back."""
    try:
        handle = os.open(lock, os.O_RDONLY | os.O_CLOEXEC)
    except OSError:
        return False
    try:
        # Held for microseconds, and shared: a server that starts just now tries for longer.
        fcntl.flock(handle, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    finally:
        os.close(handle)
    return False


def end_on_request(options: argparse.Namespace, end: Callable[[], None]) -> None:
    """Call `end` at SIGTERM or SIGINT, and as the server options ask."""
    if options.server_lock is not None:
        watch_server(options.server_lock, options.linger, SteadyClock(), end)
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: end())


def watch_server(lock: Path, linger: float, clock: Clock, end: Callable[[], None]) -> None:
    """Call `end`, once, when no server has held `lock` for `linger` s, or the file is gone.

    So a server that is killed and started again finds the process still running. A thread checks the lock.
    """

    def watch() -> None:
        seen = clock.now()
        pause = threading.Event()
        while True:
            if is_served(lock):
                seen = clock.now()
            elif not lock.exists() or clock.now() - seen >= linger:
                break
            pause.wait(_CHECK_SECONDS)
        end()

    threading.Thread(target=watch, name="server", daemon=True).start()
