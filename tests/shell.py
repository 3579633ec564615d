"""Sign-in of tests and measurements, as programs of this computer."""

from collections.abc import Generator

import httpx

from server.platform.settings import DataFolder


class ShellAuth(httpx.Auth):
    """The token of the server of this folder; each start of it makes another."""

    def __init__(self, folder: DataFolder) -> None:
        self._folder = folder

    def auth_flow(self, request: httpx.Request) -> Generator[httpx.Request, httpx.Response, None]:
        request.headers.update(shell_headers(self._folder))
        yield request


def shell_headers(folder: DataFolder) -> dict[str, str]:
    """Return the headers with the token; none before a first server has started."""
    try:
        return {"authorization": f"Bearer {folder.token.read_text().strip()}"}
    except FileNotFoundError:
        return {}
