"""`python -m tests.server.processes.small_servers FOLDER` runs small servers, one after the other.

Each server writes a line to FOLDER/servers: its process and how the one before ended; then it waits for its
end, and writes "bye". Where FOLDER/broken is, it cannot start.
"""

import os
import signal
import sys
from pathlib import Path

from server.platform.settings import DataFolder
from server.processes import backoff
from server.processes.server_runner import ServerRunner


def main() -> int:
    folder = Path(sys.argv[1])
    # test_parts covers the long pauses; here they would only be waited for.
    backoff.MAX = backoff.FIRST

    def serve(ended: str) -> int:
        if (folder / "broken").exists():
            (folder / "broken").open("a").write("x")
            return 1
        with (folder / "servers").open("a") as log:
            log.write(f"{os.getpid()} {ended}\n")
        ends = (signal.SIGINT, signal.SIGTERM)
        signal.pthread_sigmask(signal.SIG_BLOCK, ends)
        signal.sigwait(ends)
        (folder / "bye").touch()
        return 0

    return ServerRunner(serve, DataFolder(folder)).run()


if __name__ == "__main__":
    sys.exit(main())
