"""Requests to every operation, valid and invalid, that schemathesis makes from its description.

A whole server answers, over HTTP, with the runtime's end of the tests; there is no simulator and no scene. No
answer is a 5xx, but for what is documented where a part is truly silent; every answer is as described.
`python -m tests.proofs.interface EXAMPLES` asks that often of each operation; status 1 where a proof fails.
"""

import asyncio
import sys
import tempfile
import threading
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from unittest.mock import patch

import requests
import schemathesis
from hypothesis import HealthCheck, Phase, given, seed
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from schemathesis import Case, CheckContext, GenerationMode, Response
from schemathesis.core.result import Ok
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
    status_code_conformance,
)
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Origin

from robot_runtime.config import RobotConfig
from server.features.events.config import EventsConfig
from server.health.monitor import HealthMonitor
from server.http.sign_in.policy import DECLARED, Need
from server.platform.settings import DataFolder, Settings, make_folders
from server.stream import bridge
from tests.server.blocks import depth_block, state_block
from tests.server.serving import Served, serve
from tests.server.waiting import until
from tests.shell import shell_headers

AnyCase = Case[Any]
SILENT = {"putView": {503, 504}, "checkAlive": {503}, "getRobot": {503}}
"""Operations without an answer here: there is no scene, and no runtime that is alive."""
SLOW = {"importSession": 10}
"""Operations that start a process, and for how many questions to others one is put to them."""
NOBODY = EventsConfig(mqtt="mqtt://127.0.0.1:1")
"""A broker that is not there."""
READS = {Need.NOTHING.name.lower(), Need.VIEWER.name.lower()}
"""Needs of operations that no control bears on."""
SEED = 5
PATIENCE = 60.0
"""s for an answer, on a busy computer."""


class Surface:
    """A server under test; `operations` are those of its own description, by operation_id."""

    def __init__(self, served: Served) -> None:
        self.served = served
        self.url = str(served.api.base_url).removesuffix("/api/").removesuffix("/api")
        self.session = requests.Session()
        self.session.headers.update(shell_headers(served.settings.data))
        answer = self.session.get(f"{self.url}/api/openapi.json")
        answer.raise_for_status()
        result = schemathesis.openapi.from_dict(answer.json()).get_all_operations()
        self.operations = {
            result.ok().definition.raw["operationId"]: result.ok()
            for result in result
            if isinstance(result, Ok)
        }

    def take_control(self) -> None:
        """Take control, for operations that need it."""
        self.session.post(f"{self.url}/api/control/take?over=true").raise_for_status()

    def connect(self) -> ClientConnection:
        """Return a WebSocket to /api/live."""
        headers = {name: value for name, value in self.session.headers.items() if name == "authorization"}
        address = f"{self.url.replace('http', 'ws')}/api/live"
        return connect(address, origin=Origin(self.url), additional_headers=headers, max_size=None)

    def prove(self, name: str, examples: int) -> None:
        """Send this many requests to one operation. Raise the failures that schemathesis finds."""
        operation = self.operations[name]
        good = operation.as_strategy(generation_mode=GenerationMode.POSITIVE)
        bad = operation.as_strategy(generation_mode=GenerationMode.NEGATIVE)

        @seed(SEED)
        @hypothesis_settings(
            max_examples=max(examples // SLOW.get(name, 1), 1),
            deadline=None,
            database=None,
            phases=[Phase.generate, Phase.shrink],
            suppress_health_check=list(HealthCheck),
        )
        @given(case=good | bad, there=st.booleans())
        def ask(case: AnyCase, there: bool) -> None:
            if there and "session" in (case.path_parameters or {}):
                case.path_parameters["session"] = 1
            if operation.definition.raw[DECLARED] not in READS:
                self.take_control()
            response = case.call(base_url=self.url, session=self.session, timeout=PATIENCE)
            case.validate_response(response, checks=CHECKS)

        ask()


def is_no_fault(_: CheckContext, response: Response, case: AnyCase) -> None:
    """Check that there is no 5xx, except for processes that are absent here."""
    name = case.operation.definition.raw["operationId"]
    assert response.status_code < 500 or response.status_code in SILENT.get(name, ()), response.text


@schemathesis.serializer("application/zip")
def as_it_is(_: object, value: object) -> bytes:
    """Send archives unchanged."""
    return value if isinstance(value, bytes) else str(value).encode(errors="replace")


CHECKS = [
    is_no_fault,
    status_code_conformance,
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
]


@contextmanager
def run_surface() -> Iterator[Surface]:
    """A server in its own thread, with a short recording and a bookmark, until the context is left."""
    ready, leave = threading.Event(), threading.Event()
    results: list[Surface] = []

    async def run(settings: Settings) -> None:
        async with serve(settings) as served:
            await _record(served)
            results.append(await asyncio.to_thread(Surface, served))
            ready.set()
            await asyncio.to_thread(leave.wait)

    # A runtime's end that waits for a processor is not silent.
    patient = patch.object(bridge, "ANSWER_SECONDS", PATIENCE / 2)
    with patient, tempfile.TemporaryDirectory(prefix="mucat-") as name:
        folder = DataFolder(Path(name) / "data")
        make_folders(folder)
        config = Path(name) / "robot.toml"
        config.write_text('[robot]\nname = "tested"\n', encoding="utf-8")
        page = Path(name) / "page"
        page.mkdir()
        (page / "index.html").write_text("the page", encoding="utf-8")
        settings = Settings(
            data=folder, config=config, robot=RobotConfig(name="tested"), page=page, every_feature=True
        ).with_section(NOBODY)
        thread = threading.Thread(target=lambda: asyncio.run(run(settings)))
        thread.start()
        try:
            while not ready.wait(0.1):
                assert thread.is_alive(), "the server did not start"
            yield results[0]
        finally:
            leave.set()
            thread.join()


async def _record(served: Served) -> None:
    served.runtime.publish(state_block(0))
    await until(lambda: served.get(HealthMonitor).state(), "the state")
    answer = await served.api.post("/sessions", json={"name": "kept"})
    number = answer.json()["id"]
    assert number == 1
    for i in range(20):
        served.runtime.publish(depth_block(10 * i, 10))
    await served.api.post(f"/sessions/{number}/markers", json={"text": "here"})
    await served.api.post(f"/sessions/{number}/stop")


def main() -> int:
    """Exit status."""
    examples = int(sys.argv[1])
    problems = 0
    with run_surface() as surface:
        for name in surface.operations:
            try:
                surface.prove(name, examples)
            except BaseException as problem:
                if isinstance(problem, KeyboardInterrupt):
                    raise
                problems += 1
                print(f"{name}:\n{''.join(traceback.format_exception_only(problem))}", flush=True)
            else:
                print(f"{name}: no finding", flush=True)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
