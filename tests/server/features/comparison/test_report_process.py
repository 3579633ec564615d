"""The report over HTTP: made in a process of its own, whose end costs nobody else anything."""

import sys
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import httpx
import pytest

from server.features.comparison import report, report_process
from server.features.comparison.comparer import Comparer
from server.platform.schema import prepare
from server.platform.settings import Settings
from server.platform.store import Store
from tests.server.features.comparison.dives import dive, record
from tests.server.serving import Served, play
from tests.server.waiting import SECONDS


@pytest.fixture
def session(settings: Settings) -> int:
    prepare(settings.data)
    with closing(Store(settings.data.database)) as store:
        return record(store, settings, dive(), name="one")


@pytest.fixture
def python(tmp_path: Path) -> Callable[[str, int], SimpleNamespace]:
    """An interpreter in whose process these lines are run in place of writing the report."""

    def write(work: str, seconds_max: int) -> SimpleNamespace:
        script = tmp_path / "python"
        script.write_text(
            f"""#!{sys.executable}
import sys, time
from server.features.comparison import __main__ as process

def work(comparison, view):
    {work}
    return ""

process.write_report = work
process.NICENESS = 0
process.SECONDS_MAX = {seconds_max}
del sys.argv[:2]
sys.exit(process.main())
"""
        )
        script.chmod(0o700)
        return SimpleNamespace(executable=str(script))

    return write


async def ask(served: Served, session: int, **others: Any) -> httpx.Response:
    return await served.api.get(
        "/compare/report", params={"sessions": f"{session}", "by": "armed", **others}, timeout=SECONDS
    )


def test_a_report_is_not_made_in_the_server_s_process(
    settings: Settings, session: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    here: list[object] = []
    monkeypatch.setattr(Comparer, "__init__", lambda *_: here.append("compares"))
    monkeypatch.setattr(report, "write_report", lambda *_: here.append("writes"))

    async def scenario(served: Served) -> None:
        answer = await ask(served, session, view_start=0, view_end=2)
        assert answer.status_code == 200
        assert answer.headers["content-disposition"] == f'attachment; filename="comparison_{session}.html"'
        assert "Time 0 is arming." in answer.text
        assert "Plotly.newPlot" in answer.text
        assert here == []
        missing = await ask(served, 99)
        assert (missing.status_code, missing.json()["detail"].startswith("There is no session 99")) == (
            404,
            True,
        )

    play(settings, scenario)


FAILURES = [
    ("bytearray(1_500_000_000)", 60, 422, "Choose fewer sessions"),
    ("while time.process_time() < 5: pass", 1, 503, "was ended by signal SIGKILL"),
    ("raise LookupError('odd')", 60, 503, "LookupError: odd"),
]


def test_a_report_that_fails_or_exceeds_its_limits_is_an_error_in_words_and_the_next_one_is_made(
    settings: Settings,
    session: int,
    python: Callable[[str, int], SimpleNamespace],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async def scenario(served: Served) -> None:
        for work, seconds_max, status, why in FAILURES:
            monkeypatch.setattr(report_process, "sys", python(work, seconds_max))
            answer = await ask(served, session)
            assert (answer.status_code, why in answer.json()["detail"]) == (status, True), answer.text[:500]
        monkeypatch.undo()
        assert (await ask(served, session)).status_code == 200

    play(settings, scenario)
