"""The server that a page comes from, with or without a whole robot behind it."""

from pathlib import Path
from typing import Protocol

import httpx


class Site(Protocol):
    """A running server on a loopback port, and a client of it with the shell's token."""

    @property
    def url(self) -> str: ...

    @property
    def first(self) -> str:
        """Address at which a test finds a page."""
        ...

    @property
    def port(self) -> int: ...

    @property
    def data(self) -> Path:
        """Its data folder."""
        ...

    @property
    def api(self) -> httpx.Client: ...
