"""`python -m tests.server.processes.small_servers FOLDER` runs small servers, one after the other.

Each server writes a line to FOLDER/servers: its process and how the one before ended; then it waits for its
end, and writes "bye". Where FOLDER/broken is, it cannot start. Where FOLDER/exit is, it serves, writes a
line to standard error, and then calls exit(3) with the status that stands there, as a C library does; "abort"
aborts.
"""

import ctypes
import os
import signal
import sys
from collections.abc import Callable
from pathlib import Path

from robot_runtime import backoff
from server.platform.settings import DataFolder
from server.processes.server_runner import ServerRunner


def end_by_library(how: Path) -> None:
    """End this process as a library does that gets no memory, once."""
    status = how.read_text()
    how.unlink()
    os.write(2, b"Memory allocation still failed, giving up.\n")
    library = ctypes.CDLL(None)
    library.abort() if status == "abort" else library.exit(int(status))


def main() -> int:
    folder = Path(sys.argv[1])
    # test_parts covers the long pauses; here they would only be waited for.
    backoff.MAX = backoff.FIRST

    def serve(ended: str, note_serving: Callable[[], None]) -> int:
        if (folder / "broken").exists():
            (folder / "broken").open("a").write("x")
            return 1
        with (folder / "servers").open("a") as log:
            log.write(f"{os.getpid()} {ended}\n")
        note_serving()
        if (folder / "exit").exists():
            end_by_library(folder / "exit")
        ends = (signal.SIGINT, signal.SIGTERM)
        signal.pthread_sigmask(signal.SIG_BLOCK, ends)
        signal.sigwait(ends)
        (folder / "bye").touch()
        return 0

    return ServerRunner(serve, DataFolder(folder)).run()


if __name__ == "__main__":
    sys.exit(main())
