"""Requests to a robot's server, at an address and with a token."""

import json
from typing import Any
from urllib.error import HTTPError, URLError
from urllib.parse import urlsplit
from urllib.request import Request, urlopen

from mucat.errors import RobotError

SECONDS = 30.0


class RobotAddress:
    """A server, such as `http://turtle.local:8000`, and a token of `mucat access token` for it."""

    def __init__(self, url: str, token: str) -> None:
        if urlsplit(url).scheme not in ("http", "https"):
            raise RobotError(f"The address is {url!r}; it begins with http:// or https://.")
        self.url = url.rstrip("/")
        self.headers = {"Authorization": f"Bearer {token}"}

    @property
    def live(self) -> str:
        """The address of the live socket."""
        return f"{self.url.replace('http', 'ws', 1)}/api/live"

    def ask(self, method: str, path: str, body: object = None, client: str = "") -> Any:
        """Return the server's JSON answer at /api/PATH; None where it is empty.

        Raise RobotError.
        """
        text = self.fetch(method, path, body, client)
        return json.loads(text) if text else None

    def fetch(self, method: str, path: str, body: object = None, client: str = "") -> bytes:
        """Return the bytes of the server's answer. Raise RobotError."""
        headers = self.headers | ({"X-Mucat-Client": client} if client else {})
        data = None
        if body is not None:
            data, headers = json.dumps(body).encode(), headers | {"Content-Type": "application/json"}
        elif method != "GET":
            data = b""
        request = Request(f"{self.url}/api{path}", data, headers, method=method)
        try:
            with urlopen(request, timeout=SECONDS) as answer:
                content: bytes = answer.read()
        except HTTPError as problem:
            raise RobotError(_reason(problem), problem.code) from problem
        except (URLError, OSError) as problem:
            raise RobotError(f"{self.url} does not answer: {problem}.") from problem
        return content


def _reason(problem: HTTPError) -> str:
    try:
        return str(json.loads(problem.read())["detail"])
    except (ValueError, LookupError, TypeError):
        return f"The server answered {problem.code} {problem.reason}."
