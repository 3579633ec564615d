"""Every route and message of the live socket, sent by every role from every origin, against one table.

A caller who is not admitted gets exactly the status of the refusal; one who is, any other. The requests are
empty, about things that do not exist: a caller is refused before either is noticed.
The table is written here by hand, and knows nothing of the server's own: a route that is not in it fails.
"""

import asyncio
import json
import time
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field, replace
from typing import Any, Literal, cast

import pytest
from fastapi import FastAPI
from fastapi.routing import iter_route_contexts
from starlette.types import Message

from robot_runtime.clock import SimulatedClock
from server.app import create_app
from server.container import Container
from server.driving.arbiter import ControlArbiter
from server.features.events.config import EventsConfig
from server.health.monitor import HealthMonitor
from server.http.sign_in.access import Access
from server.http.sign_in.identity import SHELL
from server.http.sign_in.policy import MESSAGES
from server.platform.settings import Settings
from tests.server.blocks import state_block
from tests.server.new_database import place_with_samples
from tests.server.runtime_end import RuntimeEnd
from tests.server.waiting import until
from tests.shell import shell_headers

Least = Literal["anyone", "viewer", "archive", "operator", "control", "administer"]
Who = Literal[
    "anonymous",
    "viewer",
    "operator",
    "control",
    "program that reads",
    "program that operates",
    "program that administers",
    "lab",
    "thief of a cookie",
    "reader of another session",
]
Where = Literal["right", "wrong", "missing"]
METHODS = ("GET", "POST", "PUT", "PATCH", "DELETE", "OPTIONS")

ROUTES: dict[tuple[str, str], Least] = {
    ("GET", "/{path:path}"): "anyone",
    ("GET", "/api"): "viewer",
    **{(method, "/api/{path:path}"): "viewer" for method in METHODS},
    ("GET", "/help"): "anyone",
    ("GET", "/help/{path:path}"): "anyone",
    ("GET", "/api/openapi.json"): "viewer",
    ("HEAD", "/api/openapi.json"): "viewer",
    ("GET", "/api/access/me"): "anyone",
    ("POST", "/api/access/pair"): "anyone",
    ("POST", "/api/access/confirm"): "operator",
    ("POST", "/api/access/codes"): "administer",
    ("GET", "/api/access/devices"): "operator",
    ("PATCH", "/api/access/devices/{device}"): "administer",
    ("DELETE", "/api/access/devices/{device}"): "administer",
    ("POST", "/api/access/tokens"): "administer",
    ("POST", "/api/access/read"): "anyone",
    ("GET", "/api/access/reading-links"): "operator",
    ("POST", "/api/access/reading-links"): "operator",
    ("DELETE", "/api/access/reading-links/{link}"): "operator",
    ("GET", "/api/audit"): "operator",
    ("GET", "/api/audit/csv"): "operator",
    ("GET", "/api/control"): "viewer",
    ("GET", "/api/doors"): "viewer",
    ("POST", "/api/control/take"): "operator",
    ("POST", "/api/control/release"): "operator",
    ("GET", "/api/alive"): "anyone",
    ("GET", "/api/health"): "viewer",
    ("GET", "/api/doctor"): "operator",
    ("POST", "/api/doctor"): "operator",
    ("GET", "/api/robot"): "viewer",
    ("POST", "/api/robot/stop"): "viewer",
    ("GET", "/api/lab"): "viewer",
    ("POST", "/api/lab/join"): "administer",
    ("DELETE", "/api/lab"): "administer",
    ("GET", "/api/robots"): "viewer",
    ("POST", "/api/robots/codes"): "administer",
    ("POST", "/api/robots/join"): "anyone",
    ("POST", "/api/robots/stop"): "viewer",
    ("DELETE", "/api/robots/{robot}"): "administer",
    ("GET", "/api/firmware"): "viewer",
    ("POST", "/api/firmware"): "administer",
    ("GET", "/api/bring-up"): "viewer",
    ("GET", "/api/bring-up/report"): "viewer",
    ("POST", "/api/bring-up"): "control",
    ("POST", "/api/bring-up/actions"): "control",
    ("POST", "/api/bring-up/hands"): "control",
    ("DELETE", "/api/bring-up"): "operator",
    ("POST", "/api/robot/commands/{name}"): "viewer",
    ("POST", "/api/robot/commands/acknowledge"): "control",
    ("POST", "/api/robot/commands/arm"): "control",
    ("POST", "/api/robot/commands/mode"): "control",
    ("POST", "/api/robot/commands/check_fins"): "control",
    ("POST", "/api/robot/commands/mission_pause"): "control",
    ("POST", "/api/robot/commands/mission_skip"): "control",
    ("POST", "/api/robot/commands/mission_end"): "control",
    ("POST", "/api/robot/commands/calibrate"): "control",
    ("POST", "/api/robot/commands/measure_gyro"): "control",
    ("POST", "/api/robot/commands/zero_depth"): "control",
    ("POST", "/api/robot/commands/loop"): "control",
    ("POST", "/api/robot/commands/parameters"): "control",
    ("POST", "/api/robot/commands/vision_settings"): "control",
    ("POST", "/api/robot/commands/steering"): "control",
    ("POST", "/api/robot/commands/card"): "control",
    ("GET", "/api/vision"): "viewer",
    ("PUT", "/api/vision"): "control",
    ("POST", "/api/vision/pick"): "viewer",
    ("GET", "/api/vision/toml"): "viewer",
    ("POST", "/api/vision/read"): "viewer",
    ("GET", "/api/parameters"): "viewer",
    ("GET", "/api/parameters/changes"): "viewer",
    ("POST", "/api/parameters/undo"): "control",
    ("GET", "/api/profiles"): "viewer",
    ("POST", "/api/profiles"): "operator",
    ("POST", "/api/profiles/file"): "operator",
    ("GET", "/api/profiles/{profile}/file"): "viewer",
    ("POST", "/api/profiles/{profile}/restore"): "control",
    ("DELETE", "/api/profiles/{profile}"): "operator",
    ("PUT", "/api/simulator"): "control",
    ("PUT", "/api/scene/view"): "operator",
    ("GET", "/api/link/frames"): "viewer",
    ("GET", "/api/past"): "viewer",
    ("GET", "/api/topics"): "viewer",
    ("GET", "/api/storage"): "viewer",
    ("GET", "/api/backup"): "administer",
    ("GET", "/api/sessions"): "viewer",
    ("GET", "/api/sessions/controllers"): "viewer",
    ("GET", "/api/sessions/groups"): "viewer",
    ("GET", "/api/sessions/edits"): "viewer",
    ("GET", "/api/sessions/robots"): "viewer",
    ("POST", "/api/sessions/archived"): "archive",
    ("GET", "/api/figures"): "viewer",
    ("GET", "/api/lab/pulls"): "viewer",
    ("GET", "/api/tags"): "viewer",
    ("POST", "/api/sessions"): "operator",
    ("GET", "/api/sessions/{session}"): "viewer",
    ("PATCH", "/api/sessions/{session}"): "operator",
    ("DELETE", "/api/sessions/{session}"): "operator",
    ("POST", "/api/sessions/{session}/stop"): "operator",
    ("POST", "/api/sessions/{session}/restore"): "operator",
    ("POST", "/api/sessions/{session}/purge"): "operator",
    ("GET", "/api/sessions/{session}/thumbnail"): "viewer",
    ("GET", "/api/film"): "viewer",
    ("PUT", "/api/film"): "operator",
    ("GET", "/api/sessions/{session}/film"): "viewer",
    ("GET", "/api/sessions/{session}/film/part"): "viewer",
    ("GET", "/api/sessions/{session}/snapshots"): "viewer",
    ("GET", "/api/sessions/{session}/snapshot"): "viewer",
    ("POST", "/api/snapshots"): "operator",
    ("GET", "/api/sessions/{session}/timeline"): "viewer",
    ("GET", "/api/sessions/{session}/missions"): "viewer",
    ("GET", "/api/sessions/{session}/blocks"): "viewer",
    ("GET", "/api/sessions/{session}/pair"): "viewer",
    ("GET", "/api/sessions/{session}/signals"): "viewer",
    ("GET", "/api/sessions/{session}/spectrum"): "viewer",
    ("GET", "/api/sessions/{session}/story"): "viewer",
    ("GET", "/api/sessions/{session}/story/figures"): "viewer",
    ("GET", "/api/sessions/{session}/track"): "viewer",
    ("GET", "/api/sessions/{session}/readings"): "viewer",
    ("POST", "/api/sessions/{session}/markers"): "operator",
    ("PATCH", "/api/sessions/{session}/markers/{mark}"): "operator",
    ("DELETE", "/api/sessions/{session}/markers/{mark}"): "operator",
    ("POST", "/api/compare"): "viewer",
    ("POST", "/api/compare/lines"): "viewer",
    ("GET", "/api/compare/report"): "viewer",
    ("GET", "/api/exports"): "viewer",
    ("POST", "/api/exports"): "viewer",
    ("GET", "/api/exports/{export}"): "viewer",
    ("DELETE", "/api/exports/{export}"): "archive",
    ("GET", "/api/exports/{export}/file"): "viewer",
    ("POST", "/api/imports"): "operator",
    ("GET", "/api/update"): "viewer",
    ("POST", "/api/update"): "administer",
    ("POST", "/api/update/release"): "operator",
    ("GET", "/api/comm-tests/documents"): "viewer",
    ("POST", "/api/comm-tests/check"): "viewer",
    ("GET", "/api/comm-tests/runs"): "viewer",
    ("POST", "/api/comm-tests/runs"): "operator",
    ("POST", "/api/comm-tests/cancel"): "operator",
    ("GET", "/api/comm-tests/runs/{run}"): "viewer",
    ("GET", "/api/comm-tests/runs/{run}/csv"): "viewer",
    ("GET", "/api/comm-tests/runs/{run}/json"): "viewer",
    ("GET", "/api/comm-tests/tables"): "viewer",
    ("GET", "/api/missions"): "viewer",
    ("POST", "/api/missions"): "operator",
    ("DELETE", "/api/missions/{name}"): "operator",
    ("GET", "/api/missions/versions/{name}"): "viewer",
    ("GET", "/api/missions/runs/{name}"): "viewer",
    ("GET", "/api/missions/nodes"): "viewer",
    ("POST", "/api/missions/check"): "viewer",
    ("POST", "/api/missions/start"): "control",
    ("GET", "/api/missions/state"): "viewer",
    ("GET", "/api/missions/trial"): "viewer",
    ("POST", "/api/missions/trial"): "operator",
    ("POST", "/api/missions/trial/cancel"): "operator",
    ("GET", "/api/scenarios"): "viewer",
    ("GET", "/api/scenarios/events"): "viewer",
    ("POST", "/api/scenarios"): "operator",
    ("POST", "/api/scenarios/check"): "viewer",
    ("GET", "/api/scenarios/state"): "viewer",
    ("POST", "/api/scenarios/runs"): "operator",
    ("POST", "/api/scenarios/cancel"): "operator",
    ("GET", "/api/sweeps"): "viewer",
    ("POST", "/api/sweeps"): "operator",
    ("POST", "/api/sweeps/check"): "viewer",
    ("GET", "/api/sweeps/template"): "viewer",
    ("GET", "/api/sweeps/{sweep}"): "viewer",
    ("DELETE", "/api/sweeps/{sweep}"): "operator",
    ("GET", "/api/sweeps/{sweep}/runs"): "viewer",
    ("GET", "/api/sweeps/{sweep}/table"): "viewer",
    ("POST", "/api/sweeps/{sweep}/cancel"): "operator",
    ("POST", "/api/sweeps/{sweep}/resume"): "operator",
    ("POST", "/api/sweeps/{sweep}/profile"): "operator",
    ("POST", "/api/sweeps/{sweep}/runs/{run}/session"): "operator",
    ("GET", "/api/identification"): "viewer",
    ("POST", "/api/identification"): "operator",
    ("POST", "/api/identification/cancel"): "operator",
    ("POST", "/api/identification/adopt"): "operator",
    ("POST", "/api/identification/undo"): "operator",
    ("GET", "/api/layouts"): "viewer",
    ("POST", "/api/layouts"): "operator",
    ("GET", "/api/layouts/{layout}"): "viewer",
    ("DELETE", "/api/layouts/{layout}"): "operator",
    ("GET", "/api/panels"): "viewer",
    ("GET", "/api/panels/frame"): "viewer",
    ("GET", "/api/panels/own/{panel}"): "viewer",
    ("GET", "/api/tuning/state"): "viewer",
    ("GET", "/api/tuning/runs"): "viewer",
    ("POST", "/api/tuning/runs"): "control",
    ("POST", "/api/tuning/stop"): "control",
    ("POST", "/api/tuning/prediction"): "viewer",
    ("GET", "/api/tuning/runs/{run}"): "viewer",
    ("PATCH", "/api/tuning/runs/{run}"): "operator",
    ("DELETE", "/api/tuning/runs/{run}"): "operator",
    # Last: its requester must be paired again afterwards.
    ("POST", "/api/access/sign-out"): "viewer",
}
LIVE: dict[str, Least] = {"ping": "viewer", "watch": "viewer", "stop": "viewer", "drive": "control"}
SOCKETS = {"/api/live"}
LINKED = {
    "/api/compare/report",
    "/api/comm-tests/runs/{run}/csv",
    "/api/comm-tests/runs/{run}/json",
    "/api/exports/{export}/file",
    "/api/panels/frame",
    "/api/profiles/{profile}/file",
    "/api/sessions/{session}/snapshot",
    "/api/sessions/{session}/thumbnail",
    "/api/sweeps/{sweep}/table",
    "/api/vision/toml",
}
"""Files, pictures and frames that a page names by their address, so that the cookie alone must do."""

READER: Who = "reader of another session"
ROLES: dict[Who, int] = {
    "anonymous": 0,
    "viewer": 1,
    "program that reads": 1,
    "lab": 1,
    "operator": 2,
    "program that operates": 2,
    "program that administers": 2,
    "control": 3,
    "thief of a cookie": 0,
    READER: 0,
}
LEAST: dict[Least, int] = {
    "anyone": 0,
    "viewer": 1,
    "archive": 2,
    "operator": 2,
    "control": 3,
    "administer": 2,
}
REFUSALS = {401, 403, 423}
SAFE = {"GET", "HEAD", "OPTIONS"}
ABSENT = dict.fromkeys(
    ("robot", "session", "run", "sweep", "device", "layout", "profile", "panel", "mark", "name", "link"),
    "999",
)
ABSENT |= {"export": "0" * 16, "path": "index.html", "robot": "nobody"}
QUERIES = {"/api/control/take": "over=true"}
"""Without it, who is admitted would be refused as long as somebody else has control."""
NEAR, FAR = "127.0.0.1", "192.0.2.7"
"""Addresses that ask: this computer's own, and one elsewhere."""


def expected(
    who: Who, least: Least, *, safe: bool, host: Where, origin: Where, linked: bool = False
) -> int | None:
    """Return the status with which this is refused; None where it is accepted."""
    reader = who == READER
    browser = reader or who in ("viewer", "operator", "control")
    if host != "right" or origin == "wrong":
        return 403
    if linked and who == "thief of a cookie":
        return None
    if browser and origin == "missing" and not safe:
        return 403
    if ROLES[who] == 0:
        return None if least == "anyone" else 403 if reader else 401
    if least == "administer" and who == "program that operates":
        return 403
    if ROLES[who] >= LEAST[least] or (who, least) == ("lab", "archive"):
        return None
    return 423 if ROLES[who] == 2 else 403


@dataclass
class Somebody:
    """A requester, by the headers of each request."""

    headers: dict[str, str] = field(default_factory=dict)


def signed_in(headers: dict[str, str], report: bytes) -> dict[str, str]:
    """Return the headers of a browser's page, by the answer to its sign-in."""
    cookie, _, _ = headers["set-cookie"].partition(";")
    return {"cookie": cookie, "x-mucat": json.loads(report)["page_secret"]}


class House:
    """The whole application in this event loop, with the runtime's end and all requesters."""

    def __init__(self, app: FastAPI, settings: Settings, runtime: RuntimeEnd) -> None:
        self.app = app
        self.own = f"127.0.0.1:{settings.server.port}"
        self.container: Container = app.state.container
        self.runtime = runtime
        self.people: dict[Who, Somebody] = {"anonymous": Somebody()}
        self.shell = Somebody(shell_headers(settings.data))

    def places(self, host: Where, origin: Where) -> dict[str, str]:
        """Return the headers that name the origin of a request."""
        names = {"right": self.own, "wrong": "evil.example:8000"}
        answer = {} if host == "missing" else {"host": names[host]}
        return answer if origin == "missing" else answer | {"origin": f"http://{names[origin]}"}

    async def ask(
        self,
        who: Somebody,
        method: str,
        path: str,
        places: dict[str, str],
        body: object = None,
        *,
        query: str = "",
        address: str = NEAR,
    ) -> tuple[int, dict[str, str], bytes]:
        """Return the status, headers and body of an answer."""
        data = json.dumps({} if body is None else body).encode()
        # An archive with too large a declared size is refused before a process reads it.
        size = 10**15 if path == "/api/imports" else len(data)
        headers = places | who.headers | {"content-length": str(size), "content-type": "application/json"}
        scope = self._scope("http", path, headers, address) | {"method": method, "scheme": "http"}
        scope["query_string"] = query.encode()
        sent: list[Message] = []
        parts = iter([{"type": "http.request", "body": data, "more_body": False}])

        async def receive() -> Message:
            if (part := next(parts, None)) is not None:
                return part
            # The caller stays until it is answered.
            await asyncio.Event().wait()
            return {"type": "http.disconnect"}

        async def send(message: Message) -> None:
            sent.append(message)

        await self.app(scope, receive, send)
        named = {name.decode(): value.decode() for name, value in sent[0]["headers"]}
        return sent[0]["status"], named, b"".join(part.get("body", b"") for part in sent[1:])

    async def enter(self, who: Who) -> Somebody:
        """Return a requester that has just signed in."""
        if who == READER:
            return await self._read()
        if who == "lab":
            _, token = await self.container.services.get(Access).make_lab("Lab", SHELL)
            return Somebody({"authorization": f"Bearer {token}"})
        verb = who.removeprefix("program that ")
        if verb != who:
            return await self._program(verb.removesuffix("s"))
        return await self._pair("viewer" if who == "viewer" else "operator", who)

    async def _pair(self, role: str, name: str) -> Somebody:
        right = self.places("right", "right")
        _, _, report = await self.ask(self.shell, "POST", "/api/access/codes", right, {"role": role})
        request = {"code": json.loads(report)["code"], "name": name}
        status, headers, report = await self.ask(Somebody(), "POST", "/api/access/pair", right, request)
        assert status == 200
        return Somebody(signed_in(headers, report))

    async def _read(self) -> Somebody:
        right = self.places("right", "right")
        request = {"session": 1, "ends": time.time() + 1000}
        _, _, report = await self.ask(self.shell, "POST", "/api/access/reading-links", right, request)
        token = {"token": json.loads(report)["token"]}
        status, headers, report = await self.ask(Somebody(), "POST", "/api/access/read", right, token)
        assert status == 200
        return Somebody(signed_in(headers, report))

    async def _program(self, scope: str) -> Somebody:
        right = self.places("right", "missing")
        request = {"name": scope, "scope": scope}
        _, _, report = await self.ask(self.shell, "POST", "/api/access/tokens", right, request)
        return Somebody({"authorization": f"Bearer {json.loads(report)['token']}"})

    @asynccontextmanager
    async def socket(
        self, who: Somebody, places: dict[str, str], address: str = NEAR
    ) -> AsyncIterator["LiveSocket"]:
        """A live socket, accepted or not."""
        socket = LiveSocket()
        scope = self._scope("websocket", "/api/live", places | who.headers, address) | {"scheme": "ws"}
        scope["subprotocols"] = ["mucat", who.headers["x-mucat"]] if "x-mucat" in who.headers else []
        running = asyncio.create_task(self.app(scope, socket.receive, socket.send))
        try:
            await until(lambda: socket.opened is not None, "an answer to the handshake")
            yield socket
        finally:
            socket.to_server.put_nowait({"type": "websocket.disconnect", "code": 1000})
            await running

    def _scope(self, kind: str, path: str, headers: dict[str, str], address: str) -> dict[str, Any]:
        return {
            "type": kind,
            "asgi": {"version": "3.0"},
            "http_version": "1.1",
            "path": path,
            "raw_path": path.encode(),
            "query_string": b"",
            "root_path": "",
            "headers": [(name.encode(), value.encode()) for name, value in headers.items()],
            "client": (address, 50000),
            "server": ("127.0.0.1", 8000),
        }


class LiveSocket:
    """The page's end; `opened` is None until the handshake is answered."""

    def __init__(self) -> None:
        self.opened: bool | None = None
        self.received: list[dict[str, Any]] = []
        self.to_server: asyncio.Queue[Message] = asyncio.Queue()
        self.to_server.put_nowait({"type": "websocket.connect"})

    async def receive(self) -> Message:
        """Return the next message to the server."""
        return await self.to_server.get()

    async def send(self, message: Message) -> None:
        """Record a message of the server."""
        if message["type"] in ("websocket.accept", "websocket.close"):
            self.opened = self.opened or message["type"] == "websocket.accept"
        elif (text := message.get("text")) is not None:
            self.received.append(json.loads(text))

    async def hello(self) -> dict[str, Any]:
        """Return the greeting."""
        await until(lambda: self.received, "the greeting")
        return self.received[0]

    async def say(self, message: dict[str, Any]) -> list[str]:
        """Send a message; return the errors in answer."""
        before = len(self.received)
        for sent in (message, {"op": "ping", "id": before}):
            self.to_server.put_nowait({"type": "websocket.receive", "text": json.dumps(sent)})
        await until(
            lambda: any(message["op"] == "pong" and message["id"] == before for message in self.received),
            "the answer to a ping",
        )
        return [message["text"] for message in self.received[before:] if message["op"] == "error"]


@asynccontextmanager
async def open_house(settings: Settings) -> AsyncIterator[House]:
    """A running application with signed-in requesters; operators' browsers have a live page."""
    await place_with_samples(settings.data)
    nowhere = EventsConfig(mqtt="mqtt://127.0.0.1:1")
    app = create_app(replace(settings.with_section(nowhere), every_feature=True))
    with RuntimeEnd(settings.data.runtime_socket, settings.robot.name) as runtime:
        async with app.router.lifespan_context(app):
            house = House(app, settings, runtime)
            await until(lambda: runtime.is_heard("stream"), "the server to listen")
            runtime.publish(state_block(0))
            await until(house.container.services.get(HealthMonitor).state, "the state")
            for who in ROLES:
                if who == "thief of a cookie":
                    house.people[who] = Somebody({"cookie": house.people["operator"].headers["cookie"]})
                elif who not in ("anonymous", READER):
                    house.people[who] = await house.enter(who)
            right = house.places("right", "right")
            operator, control = house.people["operator"], house.people["control"]
            async with house.socket(operator, right) as other, house.socket(control, right) as live:
                operator.headers["x-mucat-client"] = (await other.hello())["client_key"]
                control.headers["x-mucat-client"] = (await live.hello())["client_key"]
                # While a session is recorded, no bring-up begins.
                assert (await house.ask(control, "POST", "/api/sessions", right))[0] == 201
                house.people[READER] = await house.enter(READER)
                yield house


def routes() -> Iterator[tuple[str, str]]:
    """Method and path of every route but the sockets'."""
    app = create_app(Settings(data=cast("Any", None), config=cast("Any", None), every_feature=True))
    for route in iter_route_contexts(app.routes):
        for method in getattr(route, "methods", None) or ():
            yield method, str(route.path)


def test_every_route_has_an_entry_and_every_entry_a_route() -> None:
    assert set(routes()) == set(ROUTES)
    app = create_app(Settings(data=cast("Any", None), config=cast("Any", None), every_feature=True))
    assert {context.path for context in iter_route_contexts(app.routes) if not context.methods} == SOCKETS


def test_every_message_has_an_entry_and_every_entry_a_message() -> None:
    assert MESSAGES.keys() == LIVE.keys()


WHERE: tuple[Where, ...] = ("right", "wrong", "missing")
WHENCE = [(host, origin, FAR) for host in WHERE for origin in WHERE] + [("right", "right", NEAR)]
"""Host, Origin and address. No address is trusted, so that each answer is the same from both."""


@pytest.mark.parametrize("who", ROLES)
async def test_every_route_admits_exactly_the_roles_of_the_table(settings: Settings, who: Who) -> None:
    async with open_house(settings) as house:
        surprises = await ask_everything(house, who)
        assert not surprises, "\n".join(map(str, surprises))


async def ask_everything(house: House, who: Who) -> list[tuple[object, ...]]:
    """Return all deviations from the table."""
    surprises: list[tuple[object, ...]] = []
    right = house.places("right", "right")
    for (method, template), least in ROUTES.items():
        path, query = template.replace(":path", "").format(**ABSENT), QUERIES.get(template, "")
        # Whoever has control may have given it back a moment ago, or another may have taken it.
        control = house.people["control"]
        await house.ask(control, "POST", "/api/control/take", right, query="over=true")
        for host, origin, address in WHENCE:
            places = house.places(host, origin)
            status, _, report = await house.ask(
                house.people[who], method, path, places, query=query, address=address
            )
            refusal = expected(
                who, least, safe=method in SAFE, host=host, origin=origin, linked=template in LINKED
            )
            if status != refusal if refusal else status in REFUSALS or status == 500:
                surprises.append(
                    (who, method, template, host, origin, address, refusal, status, report[:300])
                )
            if status == 204 and template.endswith("/sign-out"):
                house.people[who] = await house.enter(who)
    return surprises


async def test_every_message_is_accepted_from_exactly_the_roles_of_the_table(settings: Settings) -> None:
    async with open_house(settings) as house:
        for who in ROLES:
            for host, origin, address in WHENCE:
                target = expected(who, "viewer", safe=False, host=host, origin=origin)
                places = house.places(host, origin)
                async with house.socket(house.people[who], places, address) as socket:
                    assert socket.opened is (target is None), (who, host, origin, address)
                    if target is None:
                        await say_everything(house, who, socket)


async def say_everything(house: House, who: Who, socket: LiveSocket) -> None:
    """Each message of the socket, and one that does not exist."""
    hello = await socket.hello()
    assert await socket.say({"op": "nothing"}) != []
    assert await socket.say({"op": "watch", "pictures": []}) == []
    before = len(house.runtime.asked)
    assert await socket.say({"op": "stop"}) == []
    await until(lambda: ("stop", {}) in house.runtime.asked[before:], "the STOP")
    arbiter = house.container.services.get(ControlArbiter)
    if who == "control":
        client = arbiter.clients.get(hello["you"]["client"])
        assert client is not None
        arbiter.take(client, over=True)
    passed = arbiter.driving.counts.passed
    drive = {"op": "drive", "lease": arbiter.lease.epoch, "sequence": 1, "axes": [0.0] * 6}
    # A command grows no older on its way, however busy the computer is.
    arbiter.driving._clock = clock = SimulatedClock(house.container.clock.now())
    errors = await socket.say(drive | {"taken": clock.now()})
    assert (errors != []) is (ROLES[who] < LEAST["operator"])
    assert arbiter.driving.counts.passed - passed == (who == "control")
