"""Turns of requests: viewers wait for each other, and where memory is short only the robot is operated."""

import asyncio
from collections import Counter
from types import SimpleNamespace
from typing import Any

import pytest
from starlette.types import Message, Receive, Scope, Send

from server.http.sign_in.identity import IDENTITY, SHELL, Identity
from server.http.turns import REQUESTS_AT_ONCE, STOP_PATHS, STOPS_AT_ONCE, RequestTurns
from server.platform.memory_reserve import MemoryReserve

VIEWER = Identity(7, "Viewer", "viewer", "program")
OTHER = Identity(8, "Other", "viewer", "program")


class Crowd:
    """Requests to an application that answers nothing until it may, behind `RequestTurns`."""

    def __init__(self, *, short: bool = False) -> None:
        self.begun: Counter[tuple[int, str]] = Counter()
        self.answers: list[int | str] = []
        self.may_end = asyncio.Event()
        self._turns = RequestTurns(self._answer)
        services = {MemoryReserve: SimpleNamespace(short=short)}
        self._app = SimpleNamespace(state=SimpleNamespace(services=services))

    def ask(self, caller: Identity | None, path: str, kind: str = "http") -> asyncio.Task[None]:
        """Begin a request."""
        scope: Scope = {"type": kind, "path": path, "app": self._app, "headers": [], IDENTITY: caller}
        return asyncio.create_task(self._turns(scope, self._receive, self._send))

    async def _answer(self, scope: Scope, _: Receive, __: Send) -> None:
        caller = scope[IDENTITY]
        self.begun[caller.device if caller else -1, scope["path"]] += 1
        await self.may_end.wait()

    async def _receive(self) -> Message:
        return {"type": "http.request"}

    async def _send(self, message: Any) -> None:
        if message["type"] in ("http.response.start", "websocket.close"):
            self.answers.append(message.get("status", message.get("reason")))


async def turn_over() -> None:
    for _ in range(5):
        await asyncio.sleep(0)


async def test_a_viewer_s_device_has_a_few_requests_under_way_and_its_stops_besides() -> None:
    crowd = Crowd()
    asked = [crowd.ask(VIEWER, "/api/past") for _ in range(100)]
    asked += [crowd.ask(VIEWER, STOP_PATHS[0]) for _ in range(100)]
    asked += [crowd.ask(OTHER, STOP_PATHS[0]), crowd.ask(SHELL, STOP_PATHS[0])]
    asked += [crowd.ask(SHELL, "/api/past") for _ in range(50)]
    await turn_over()
    assert crowd.begun == {
        (VIEWER.device, "/api/past"): REQUESTS_AT_ONCE,
        (VIEWER.device, STOP_PATHS[0]): STOPS_AT_ONCE,
        (OTHER.device, STOP_PATHS[0]): 1,
        (SHELL.device, STOP_PATHS[0]): 1,
        (SHELL.device, "/api/past"): 50,
    }
    crowd.may_end.set()
    await asyncio.gather(*asked)
    assert crowd.begun[VIEWER.device, "/api/past"] == crowd.begun[VIEWER.device, STOP_PATHS[0]] == 100


@pytest.mark.parametrize("path", [*STOP_PATHS, "/api/robot/commands/arm", "/api/control/take", "/api/alive"])
@pytest.mark.parametrize("caller", [VIEWER, SHELL])
async def test_where_memory_is_short_the_robot_is_operated(caller: Identity, path: str) -> None:
    crowd = Crowd(short=True)
    asked = crowd.ask(caller, path)
    await turn_over()
    assert crowd.begun == {(caller.device, path): 1}
    crowd.may_end.set()
    await asked


@pytest.mark.parametrize("path", ["/api/past", "/api/sessions/1", "/api/imports", "/api/robotics"])
async def test_where_memory_is_short_everything_else_is_refused_in_words(path: str) -> None:
    crowd = Crowd(short=True)
    crowd.may_end.set()
    await asyncio.gather(crowd.ask(VIEWER, path), crowd.ask(SHELL, path))
    assert crowd.answers == [503, 503]
    assert not crowd.begun


async def test_where_memory_is_short_operators_get_a_socket_and_viewers_do_not() -> None:
    crowd = Crowd(short=True)
    crowd.may_end.set()
    await asyncio.gather(*(crowd.ask(identity, "/api/live", "websocket") for identity in (VIEWER, SHELL)))
    assert crowd.begun == {(SHELL.device, "/api/live"): 1}
    (reason,) = crowd.answers
    assert "little memory" in str(reason)
