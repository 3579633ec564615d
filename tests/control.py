"""A client of a running robot that takes control for each command only."""

from typing import Any

import httpx


class Commander(httpx.Client):
    """Takes control for each command that needs it, and releases it afterwards."""

    def request(self, method: str, url: httpx.URL | str, **options: Any) -> httpx.Response:
        answer = super().request(method, url, **options)
        if answer.status_code != 423 or "X-Mucat-Client" in (options.get("headers") or {}):
            return answer
        self.post("/control/take", params={"over": True}).raise_for_status()
        answer = super().request(method, url, **options)
        self.post("/control/release").raise_for_status()
        return answer
