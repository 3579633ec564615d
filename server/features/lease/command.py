"""Control of the robot for a command in a shell: taken before, kept while it runs, released after."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress

from server.platform.running_server import ask
from server.platform.settings import DataFolder, SetupError


@contextmanager
def in_control(folder: DataFolder) -> Iterator[None]:
    """Take control if it is free. Raises SetupError where it is not."""
    ask(folder, "POST", "/control/take")
    try:
        yield
    finally:
        # A server that is gone has ended the lease, too.
        with suppress(SetupError):
            ask(folder, "POST", "/control/release")


def renew_control(folder: DataFolder) -> None:
    """Keep control that nobody has taken over; to be called every few seconds."""
    # Without it, what was begun with it goes on.
    with suppress(SetupError):
        ask(folder, "POST", "/control/take")
