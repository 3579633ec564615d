"""Comparisons and reports over HTTP: made in processes of their own, whose end costs nobody else anything."""

import asyncio
import os
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import httpx
import pytest

from robot_runtime.profile import Profile
from server.analysis import report
from server.analysis.comparer import Comparer
from server.analysis.schemas import ComparisonQuery, LinesQuery
from server.features.comparison import worker
from server.features.comparison.plug import ComparisonPlug
from server.features.comparison.worker import ComparisonError, ComparisonWorker
from server.platform.settings import Settings
from server.platform.store import Reader
from server.processes import task_process
from tests.server.serving import Served, serve
from tests.server.waiting import SECONDS, alive, until

Python = Callable[[str], SimpleNamespace]


@pytest.fixture
def python(tmp_path: Path) -> Python:
    """An interpreter in whose process comparing is these lines; signals are listed as ever."""

    def write(work: str) -> SimpleNamespace:
        script = tmp_path / "python"
        script.write_text(
            f"""#!{sys.executable}
import sys, time
from server.features.comparison import __main__ as process, tasks

def work(comparer, query):
    {work}
    return b"{{}}"

tasks.TASKS = {{**tasks.TASKS, "compare": work, "report": work}}
process.NICENESS = 0
del sys.argv[:2]
sys.exit(process.main())
"""
        )
        script.chmod(0o700)
        return SimpleNamespace(executable=str(script))

    return write


async def ask(served: Served, session: int, **others: Any) -> httpx.Response:
    return await served.api.get("/compare/report", params={"sessions": f"{session}", "by": "armed", **others})


async def compare(served: Served, session: int, path: str = "/compare") -> httpx.Response:
    query = {"sessions": [session], "signals": ["depth.depth"]}
    return await served.api.post(path, json=query)


def process_of(served: Served) -> int:
    """Return the process that compares for this server."""
    process = served.get(ComparisonWorker)._process
    assert process is not None
    return process.pid


async def test_nothing_is_compared_in_the_server_s_process(
    settings: Settings, session: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    reader = Reader(settings.data.database)
    query = ComparisonQuery(sessions=[session], signals=["depth.depth"])
    expected = Comparer(reader).compare(query).model_dump(mode="json")
    lines = Comparer(reader).lines(LinesQuery(sessions=[session], signals=["depth.depth"]))
    here: list[object] = []
    monkeypatch.setattr(Comparer, "__init__", lambda *_: here.append("compares"))
    monkeypatch.setattr(report, "write_report", lambda *_: here.append("writes"))

    async with serve(settings) as served:
        answer = await ask(served, session, view_start=0, view_end=2)
        assert answer.status_code == 200
        assert answer.headers["content-disposition"] == f'attachment; filename="comparison_{session}.html"'
        assert "Time 0 is arming." in answer.text
        assert "Plotly.newPlot" in answer.text
        assert (await compare(served, session)).json() == expected
        process = process_of(served)
        assert (await compare(served, session, "/compare/lines")).json() == lines.model_dump(mode="json")
        names = [signal["name"] for signal in (await served.api.get(f"/sessions/{session}/signals")).json()]
        assert "depth.depth" in names
        assert process_of(served) == process
        for missing in (await ask(served, 99), await compare(served, 99)):
            detail = missing.json()["detail"]
            assert (missing.status_code, detail.startswith("There is no session 99")) == (404, True)
        assert here == []


FAILURES = [
    ("bytearray(1_500_000_000)", SECONDS, 422, "Choose fewer sessions"),
    ("time.sleep(3600)", 1.0, 503, "given up after 1 s. Choose fewer sessions"),
    ("raise LookupError('odd')", SECONDS, 503, "LookupError: odd"),
    ("sys.exit(7)", SECONDS, 503, "has ended with exit status 7"),
]


@pytest.mark.parametrize(("work", "seconds", "status", "why"), FAILURES)
async def test_what_fails_or_exceeds_its_limits_is_an_error_in_words_and_the_next_is_answered(
    session: int,
    python: Python,
    monkeypatch: pytest.MonkeyPatch,
    work: str,
    seconds: float,
    status: int,
    why: str,
    served: Served,
) -> None:
    monkeypatch.setattr(task_process, "sys", python(work))
    monkeypatch.setattr(worker, "SECONDS_MAX", seconds)
    monkeypatch.setattr(worker, "REPORT_SECONDS_MAX", seconds)
    for answer in (await ask(served, session), await compare(served, session)):
        assert (answer.status_code, why in answer.json()["detail"]) == (status, True), answer.text[:500]
    monkeypatch.setattr(worker, "SECONDS_MAX", SECONDS)
    assert (await served.api.get(f"/sessions/{session}/signals")).status_code == 200


async def test_a_killed_process_is_started_again(session: int, served: Served) -> None:
    before = await compare(served, session)
    process = served.get(ComparisonWorker)._process
    assert process is not None
    os.kill(process.pid, signal.SIGKILL)
    await until(lambda: process.ended, "its end")
    assert (await compare(served, session)).json() == before.json()
    assert process_of(served) != process.pid


async def test_a_process_that_is_killed_while_it_compares_is_told_in_words(
    session: int, python: Python, monkeypatch: pytest.MonkeyPatch, served: Served
) -> None:
    monkeypatch.setattr(task_process, "sys", python("time.sleep(3600)"))
    asking = asyncio.create_task(compare(served, session))
    await until(lambda: served.get(ComparisonWorker)._process is not None, "the process")
    os.kill(process_of(served), signal.SIGKILL)
    answer = await asking
    assert (answer.status_code, "was ended by signal SIGKILL" in answer.json()["detail"]) == (503, True)
    monkeypatch.undo()
    assert (await compare(served, session)).status_code == 200


async def test_the_process_ends_when_nobody_asks_any_more(
    settings: Settings, session: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(worker, "IDLE_SECONDS", 0.01)

    async with serve(settings) as served:
        comparison = served.get(ComparisonWorker)
        assert (await compare(served, session)).status_code == 200
        await until(lambda: comparison._process is None, "the process to be left")
        assert (await compare(served, session)).status_code == 200


@pytest.mark.parametrize("roomy", [True, False])
async def test_only_a_roomy_computer_has_the_process_before_anybody_asks_and_keeps_it(
    settings: Settings, session: int, monkeypatch: pytest.MonkeyPatch, roomy: bool
) -> None:
    monkeypatch.setattr(worker, "IDLE_SECONDS", 0.01)
    monkeypatch.setattr(worker, "ROOMY_BYTES", 0 if roomy else 10**18)
    comparison = ComparisonWorker(settings.data)
    comparison.prepare()
    assert (comparison._preparing is not None) is roomy
    if roomy:
        await until(lambda: comparison._process is not None, "the process")
    process = comparison._process
    await comparison.ask("signals", str(session))
    assert (comparison._process is process) is roomy
    assert (comparison._idle is None) is roomy
    await comparison.close()


@pytest.mark.parametrize("profile", ["full", "lean"])
def test_where_processor_time_is_scarce_it_starts_only_when_somebody_asks(
    settings: Settings, monkeypatch: pytest.MonkeyPatch, profile: Profile
) -> None:
    prepared: list[ComparisonWorker] = []
    monkeypatch.setattr(ComparisonWorker, "prepare", lambda self: prepared.append(self))
    here = replace(settings, robot=replace(settings.robot, profile=profile))
    comparison = ComparisonWorker(here.data)
    unused = cast(Any, None)
    ComparisonPlug(comparison, unused, unused, here).warm_up()
    assert prepared == ([comparison] if profile == "full" else [])


async def test_a_report_ends_with_the_connection_of_its_receiver(
    settings: Settings, session: int, python: Python, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun = tmp_path / "begun"
    work = f"import os; open({str(begun)!r}, 'w').write(str(os.getpid())); time.sleep(3600)"

    async with serve(settings) as served:
        monkeypatch.setattr(task_process, "sys", python(work))
        asking = asyncio.create_task(ask(served, session))
        await until(lambda: begun.exists() and begun.read_text(), "the report to be begun")
        pid = int(begun.read_text())
        asking.cancel()
        try:
            await until(lambda: not alive(pid), "its process to end")
        finally:
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)


async def test_a_report_whose_receiver_hangs_up_while_it_is_read_holds_up_no_other_request(
    settings: Settings, session: int, python: Python, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun = tmp_path / "begun"
    head = b'{"status": 200, "bytes": 200000000}\n'
    # The first megabyte has passed through the pipe when the file appears; the rest is under way.
    work = (
        f"write = sys.stdout.buffer.write; write({head!r}); write(bytes(10**6)); open({str(begun)!r}, 'w'); "
        "[write(bytes(10**5)) for _ in range(1990)]"
    )

    async with serve(settings) as served:
        with monkeypatch.context() as faked:
            faked.setattr(task_process, "sys", python(work))
            asking = asyncio.create_task(ask(served, session))
            await until(begun.exists, "the answer to be read")
            asking.cancel()
        assert (await compare(served, session)).status_code == 200


async def test_no_process_is_left_and_a_missing_interpreter_is_an_error_in_words(
    settings: Settings, session: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    comparison = ComparisonWorker(settings.data)
    await comparison.ask("signals", str(session))
    process = comparison._process
    assert process is not None
    await comparison.close()
    assert process.ended
    monkeypatch.setattr(task_process, "sys", SimpleNamespace(executable="/nowhere/python"))
    with pytest.raises(ComparisonError, match="no process can be started"):
        await ComparisonWorker(settings.data).ask("signals", str(session))
