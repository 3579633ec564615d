"""Communication tests over HTTP, with the lab's own process on emulated boards."""

import asyncio
import csv
import io
import json
import signal
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, closing
from pathlib import Path
from typing import Any

import psutil
import pytest
from websockets.asyncio.client import ClientConnection

from robot_runtime.experiments.comm_test.document import read_document
from server.features.comm_tests.runner import CommTestRunner, Progress
from server.features.events.config import EventsConfig
from server.platform.settings import Settings
from tests.board.rig import ROOT, build
from tests.server.features.events.rig import MqttListener, broker
from tests.server.ports import reserved_port
from tests.server.serving import Served, next_text, serve
from tests.server.waiting import until
from tests.waiting import SECONDS

QUICK: dict[str, Any] = {
    "id": 1,
    "name": "two delays",
    "ino_path": "comm_test/comm_test.ino",
    "delay": [0.0, 0.01],
    "baud_rate": [115200],
    "from_val": 1,
    "to_val": 13,
    "expected": 12,
    "arduinodelay": [0.0],
    "framing": "plain",
}
ENDLESS = QUICK | {
    "name": "endless",
    "delay": [0.0, 10.0],
    "from_val": 0,
    "to_val": 1000,
    "expected": 1000,
    "framing": "thesis",
}
"""Its second cell is three hours of emulated time: a minute and more, computed beside the first."""


@pytest.fixture(scope="module", autouse=True)
def _board() -> None:
    build(ROOT / "firmware/emulator")


def text(*tests: dict[str, Any]) -> str:
    return json.dumps(tests)


@asynccontextmanager
async def watching(served: Served) -> AsyncIterator[ClientConnection]:
    async with served.connect() as socket:
        yield socket


async def start(served: Served, *tests: dict[str, Any]) -> int:
    answer = await served.api.post("/comm-tests/runs", json={"text": text(*tests), "place": "emulated"})
    assert answer.status_code == 201, answer.text
    number: int = answer.json()["run"]
    return number


async def news_until(socket: ClientConnection, *, cell: int | None = None) -> list[dict[str, Any]]:
    """Messages about the tests up to this cell, or until nothing runs any longer."""
    notices: list[dict[str, Any]] = []
    async with asyncio.timeout(SECONDS):
        while True:
            notices.append(await next_text(socket, "comm_test"))
            if cell is None and len(notices) > 1 and notices[-1]["active"] is None:
                return notices
            if cell is not None and (notices[-1]["cell"] or {}).get("number") == cell:
                return notices


async def get(served: Served, path: str) -> Any:
    answer = await served.api.get(f"/comm-tests/{path}")
    assert answer.status_code == 200, answer.text
    return answer.json()


def test_the_remaining_time_is_that_of_cells_and_not_of_the_start() -> None:
    progress = Progress(read_document(text(QUICK)), "emulated", 0.0, [[1.0, 1.0, 2.0]])
    assert progress.describe(60.0)["remaining"] is None
    # A minute until the first cell has ended, most of it for a compiler.
    progress.count(0, 60.0)
    assert progress.describe(60.0)["remaining"] is None
    progress.count(1, 62.0)
    assert progress.describe(62.0)["remaining"] == pytest.approx(4.0)
    progress.count(2, 66.0)
    assert progress.describe(66.0)["remaining"] == 0


async def test_a_document_is_run_test_by_test_and_every_page_sees_it(settings: Settings) -> None:
    async with serve(settings) as served, watching(served) as socket:
        first = await start(served, QUICK, QUICK | {"direction": "both", "framing": "robot"})
        report = await news_until(socket, cell=1)
        active = report[-1]["active"]
        assert (active["run"], active["name"], active["place"]) == (first, "two delays", "emulated")
        assert (active["test"], active["tests"], active["cells"], active["done"]) == (0, 2, 2, 2)
        assert active["remaining"] > 0
        assert report[-1]["cell"]["run"] == first
        await until(lambda: not served.get(CommTestRunner).busy, "the end", 200)

        second, item = [run for run in await get(served, "runs") if not run["sample"]]
        assert (item["id"], item["state"], item["cells"], item["cells_done"]) == (first, "complete", 2, 2)
        assert (item["framing"], item["place"], item["rate_mean"], item["rate_min"]) == (
            "plain",
            "emulated",
            1,
            1,
        )
        assert (second["framing"], second["direction"], second["state"]) == ("robot", "both", "complete")
        run = await get(served, f"runs/{first}")
        assert run["document"]["delay"] == [0.0, 0.01]
        assert run["tools"]["emulated board"]
        assert [cell["pi_delay"] for cell in run["results"]] == [0.0, 0.01]
        assert run["results"][1] == {
            name: value for name, value in report[-1]["cell"].items() if name != "run"
        }
        table = await served.api.get(f"/comm-tests/runs/{first}/csv")
        assert "attachment" in table.headers["content-disposition"]
        assert [row["rate"] for row in csv.DictReader(io.StringIO(table.text))] == ["1.0", "1.0"]
        whole = (await served.api.get(f"/comm-tests/runs/{first}/json")).json()
        assert (whole["place"], len(whole["cells"])) == ("emulated", 2)
    async with serve(settings) as served, watching(served) as socket:
        assert (await get(served, "runs"))[0] == second


async def test_a_run_cancelled_within_a_cell_keeps_the_finished_cells(served: Served) -> None:
    async with watching(served) as socket:
        assert (await served.api.post("/comm-tests/cancel")).status_code == 204
        number = await start(served, ENDLESS, QUICK)
        busy = await served.api.post("/comm-tests/runs", json={"text": text(QUICK), "place": "emulated"})
        assert (busy.status_code, "A communication test is running" in busy.json()["detail"]) == (
            409,
            True,
        )
        await news_until(socket, cell=0)
        stale = await served.api.post(f"/comm-tests/cancel?run={number - 1}")
        assert (stale.status_code, "This communication test is over" in stale.text) == (409, True)
        assert (await served.api.post(f"/comm-tests/cancel?run={number}")).status_code == 204
        await until(lambda: not served.get(CommTestRunner).busy, "the end")
        async with watching(served) as late:
            assert (await next_text(late, "comm_test"))["active"] is None
        run, *others = [run for run in await get(served, "runs") if not run["sample"]]
        assert (run["id"], run["state"], run["problem"], run["cells_done"]) == (
            number,
            "cancelled",
            "",
            1,
        )
        assert run["ended"]
        assert others == []


async def test_a_killed_lab_process_fails_its_run_only(served: Served) -> None:
    async with watching(served) as socket:
        number = await start(served, ENDLESS)
        await news_until(socket, cell=0)
        (comm_tests,) = [
            child
            for child in psutil.Process().children()
            if "robot_runtime.experiments.comm_test" in " ".join(child.cmdline())
        ]
        boards = comm_tests.children(recursive=True)
        comm_tests.send_signal(signal.SIGKILL)
        await until(lambda: not served.get(CommTestRunner).busy, "the end")
        run = await get(served, f"runs/{number}")
        assert (run["state"], run["cells_done"]) == ("failed", 1)
        assert "was ended by signal SIGKILL" in run["problem"]
        assert boards
        await until(lambda: not any(board.is_running() for board in boards), "the boards' end")
        await start(served, QUICK)
        await until(lambda: not served.get(CommTestRunner).busy, "the next run's end", 60)
        assert (await get(served, "runs"))[0]["state"] == "complete"


async def test_the_end_of_the_server_cancels_the_run(settings: Settings, tmp_path: Path) -> None:
    with reserved_port() as port, broker(tmp_path, port), closing(MqttListener(port)) as listener:
        telling = settings.with_section(EventsConfig(mqtt=f"mqtt://127.0.0.1:{port}"))
        async with serve(telling) as served, watching(served) as socket:
            number = await start(served, ENDLESS)
            await news_until(socket, cell=0)
        async with serve(settings) as served:
            assert (await get(served, f"runs/{number}"))["state"] == "cancelled"
        # The server waits for it, but not longer than 2 s.
        event = await asyncio.to_thread(listener.next, "mucat/tested/event/comm_test_ended")
        assert (event["id"], event["state"]) == (number, "cancelled")


@pytest.mark.parametrize(
    ("program", "message"),
    [
        ("echo out of oil >&2; exit 3", "has ended with exit status 3"),
        ("""echo '{"event": "phase", "test": 0}'""", "that is not valid"),
        ("""echo '{"event": "cell", "test": 0, "number": 0, "values": {}}'""", "that is not valid"),
        ("""echo '{"event": "cell", "test": 0, "number": 9, "values": 3}'""", "that is not valid"),
        ("head -c 300000 /dev/zero; exit 0", "It broke off"),
    ],
)
async def test_the_output_of_a_broken_lab_is_reported_up_to_a_limit(
    settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, program: str, message: str
) -> None:
    started = '{"event": "started", "test": 0, "firmware": "f", "tools": {}, "host": "h"}'
    script = tmp_path / "lab"
    script.write_text(f"#!/bin/sh\necho '{started}'\n{program}\n", encoding="utf-8")
    script.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(script))

    async with serve(settings) as served:
        number = await start(served, QUICK)
        await until(lambda: not served.get(CommTestRunner).busy, "the end")
        run = await get(served, f"runs/{number}")
        assert run["state"] == "failed"
        assert message in run["problem"]
        assert len(run["problem"]) < 200_000


async def test_a_lab_that_cannot_start_reports_the_reason(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "executable", "/bin/false")

    async with serve(settings) as served:
        body = {"text": text(QUICK), "place": "emulated"}
        answer = await served.api.post("/comm-tests/runs", json=body)
        assert answer.status_code == 409
        assert "could not begin. It has ended with exit status 1" in answer.json()["detail"]
        assert not any(not run["sample"] for run in await get(served, "runs"))


REFUSED: list[tuple[dict[str, Any], str]] = [
    ({"delay": [-1]}, "test 1: delay[0] is -1; it must lie between 0 and 10"),
    ({"delay": []}, "test 1: delay"),
    ({"baud_rate": [230400]}, "test 1: baud_rate[0]"),
    ({"arduinodelay": ["a"]}, "test 1: arduinodelay[0]"),
    ({"from_val": 20}, "test 1: "),
    ({"expected": 3}, "test 1: expected"),
    ({"framing": "none"}, "test 1: framing"),
    ({"direction": "up"}, "test 1: direction"),
    ({"ino_path": "../../etc/passwd"}, "test 1: ino_path"),
    ({"name": ""}, "test 1: name"),
    ({"speed": 3}, "test 1: 'speed' is not known here"),
    (
        {"delay": [number / 1000 for number in range(501)]},
        "501 cells; at most 500 can be run",
    ),
]


async def test_a_document_is_checked_field_by_field(served: Served) -> None:

    async def check(content: str) -> Any:
        answer = await served.api.post("/comm-tests/check", json={"text": content})
        assert answer.status_code == 200
        return answer.json()

    for changes, message in REFUSED:
        result = await check(text(QUICK | changes))
        assert result["tests"] == []
        assert any(message in problem["text"] for problem in result["problems"]), (changes, result)
        body = {"text": text(QUICK | changes), "place": "emulated"}
        answer = await served.api.post("/comm-tests/runs", json=body)
        assert (answer.status_code, message in answer.json()["detail"]) == (422, True)
        assert answer.json()["problems"] == result["problems"]
    for content in ("", "nonsense", "{}", "[]", "[3]", "[" * 50_000):
        assert (await check(content))["problems"]
    (good,) = (await check(text(QUICK)))["tests"]
    assert (good["cells"], good["bauds"], good["pi_delays"]) == (2, [115200], [0.0, 0.01])
    assert 0 < good["seconds"] < 5


async def test_an_invalid_request_is_refused(served: Served) -> None:
    api = served.api
    for body in (
        {"text": text(QUICK)},
        {"text": text(QUICK), "place": "moon"},
        {"text": text(QUICK), "place": "emulated", "speed": 3},
        {"text": 3, "place": "emulated"},
        {"text": " " * 61_000, "place": "emulated"},
    ):
        assert (await api.post("/comm-tests/runs", json=body)).status_code == 422
    number = await api.post("/comm-tests/check", json={"text": 3})
    (problem,) = number.json()["problems"]
    assert problem["path"] == ["body", "text"]
    assert number.json()["detail"] == f"The request is not valid. {problem['text']}"
    large = await api.post("/comm-tests/check", json={"text": " " * 70_000})
    assert large.status_code == 413
    for path in ("runs/99", "runs/99/csv", "runs/99/json"):
        answer = await api.get(f"/comm-tests/{path}")
        assert (answer.status_code, "There is no run 99" in answer.json()["detail"]) == (404, True)
    for path in ("runs/0", "runs/x", f"runs/{2**63}"):
        assert (await api.get(f"/comm-tests/{path}")).status_code == 422


async def test_documents_and_the_thesis_s_tables_are_shown(served: Served) -> None:
    documents = await get(served, "documents")
    assert documents[0]["name"] == "figure10"
    assert all(document["title"] and document["text"] for document in documents)
    table5, table6 = await get(served, "tables")
    assert (table5["name"], table5["framing"], len(table5["cells"])) == ("table5", "plain", 15)
    assert (table6["name"], table6["framing"], len(table6["cells"])) == ("table6", "thesis", 75)
