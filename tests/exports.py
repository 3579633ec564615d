"""Exports of a running server, over its HTTP interface."""

import time
from typing import Any, Protocol

from tests.waiting import SECONDS

_POLL = 0.05


class HttpClient(Protocol):
    """A client of httpx, or a session of requests."""

    def get(self, url: str) -> Any: ...

    def post(self, url: str, *, json: Any) -> Any: ...

    def delete(self, url: str) -> Any: ...


def export_session(client: HttpClient, session: int, format_: str = "csv", base: str = "") -> Any:
    """Return the file of a session's export in this format; the export is deleted afterwards."""
    answer = client.post(f"{base}/exports", json={"session": session, "format": format_})
    answer.raise_for_status()
    job: dict[str, Any] = answer.json()
    end = time.monotonic() + SECONDS
    while job["state"] not in ("done", "failed"):
        assert time.monotonic() < end, job
        time.sleep(_POLL)
        job = client.get(f"{base}/exports/{job['id']}").json()
    assert job["state"] == "done", job
    file = client.get(f"{base}/exports/{job['id']}/file")
    file.raise_for_status()
    client.delete(f"{base}/exports/{job['id']}").raise_for_status()
    return file
