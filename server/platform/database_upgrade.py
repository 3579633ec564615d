"""The upgrade of the database at a start."""

import os
import sys
import traceback

from server.platform.command_line import CommandError
from server.platform.settings import DataFolder, SetupError


def upgrade_apart(folder: DataFolder) -> bool:
    """Upgrade the database in a process of its own, whose libraries nobody needs afterwards.

    Return False where it cannot be used, which is said. No thread may run yet.
    """
    pid = os.fork()
    if pid == 0:
        status = 1
        try:
            from server.platform.schema import prepare

            prepare(folder)
            status = 0
        except SetupError as problem:
            CommandError(str(problem)).show()
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stderr.flush()
            os._exit(status)
    return os.waitpid(pid, 0)[1] == 0
