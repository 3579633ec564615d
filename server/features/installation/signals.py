"""The signals by which a shell or the system ends a program."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager

ENDING = (signal.SIGHUP, signal.SIGINT, signal.SIGTERM)
"""A lost ssh session, Ctrl-C, and `kill` or the computer's end."""


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Ignore these signals meanwhile, here and in the commands; only in the main thread.

    The next start repairs an installation that a power cut ends; nothing repairs one ended by a signal.
    """
    before = {number: signal.signal(number, signal.SIG_IGN) for number in ENDING}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
