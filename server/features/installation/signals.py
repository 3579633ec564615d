"""The signals by which a shell or the system ends a program."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager

ENDING = (signal.SIGHUP, signal.SIGINT, signal.SIGTERM)
"""A lost ssh session, Ctrl-C, and `kill` or the computer's end."""


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Ignores these signals meanwhile, here and in the commands that are run; in the main thread alone.

    What a power cut ends all the same is put right at the next start; nothing else would do that.
    """
    before = {one: signal.signal(one, signal.SIG_IGN) for one in ENDING}
    try:
        yield
    finally:
        for one, handler in before.items():
            signal.signal(one, handler)
