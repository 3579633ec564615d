"""A client of a running robot that has control whenever it needs it, and at no other time."""

import time
from typing import Any

import httpx

_PATIENCE = 15.0
"""s; whoever has control has 10 s to refuse."""
_POLL = 0.05


class Commander(httpx.Client):
    """Takes control for each command that needs it, and gives it back: the next page finds it free."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._seat = 0
        self._key = {"X-Mucat-Seat": ""}

    def request(self, method: str, url: httpx.URL | str, **options: Any) -> httpx.Response:
        answer = super().request(method, url, **options)
        if answer.status_code != 423 or "X-Mucat-Seat" in (options.get("headers") or {}):
            return answer
        self._take()
        answer = super().request(
            method, url, **options | {"headers": {**(options.get("headers") or {}), **self._key}}
        )
        self.post("/control/release", headers=self._key).raise_for_status()
        return answer

    def _take(self) -> None:
        answer = self.post("/control/take", headers=self._key)
        if answer.status_code == 409:
            seat = self.post("/control/seat").raise_for_status().json()
            self._seat, self._key = seat["seat"], {"X-Mucat-Seat": seat["key"]}
            answer = self.post("/control/take", headers=self._key)
        end = time.monotonic() + _PATIENCE
        while (holder := answer.raise_for_status().json()["holder"]) is None or holder["seat"] != self._seat:
            assert time.monotonic() < end, f"control stays with {holder}"
            time.sleep(_POLL)
            answer = self.post("/control/renew", headers=self._key)
