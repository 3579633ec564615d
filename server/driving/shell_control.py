"""Control of the robot for a shell command: taken before it, renewed during it, released after it."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress

from server.platform.running_server import ask
from server.platform.settings import DataFolder, SetupError


@contextmanager
def in_control(folder: DataFolder, *, over: bool) -> Iterator[None]:
    """Take control if it is free, `over` also from somebody else. Raise SetupError where it is not free."""
    try:
        ask(folder, "POST", f"/control/take{'?over=true' if over else ''}")
    except SetupError as problem:
        if over or "Control is with" not in str(problem):
            raise
        raise SetupError(f"{problem} The same command takes it over with --take-over.") from problem
    try:
        yield
    finally:
        # A server that has ended has ended the lease, too.
        with suppress(SetupError):
            ask(folder, "POST", "/control/release")


def renew_control(folder: DataFolder) -> None:
    """Renew control; call this every few seconds.

    It does nothing while somebody else has control, and takes control again once it is released.
    """
    with suppress(SetupError):
        ask(folder, "POST", "/control/take")
