"""A short version of `make kills`, and kills of the other processes, one by one."""

import json
import sqlite3
import time
from contextlib import closing
from pathlib import Path

import psutil
import pytest

from tests.proofs.kills import measure_on
from tests.stack import Stack
from tests.waiting import SECONDS

pytestmark = pytest.mark.stack


def test_a_server_that_is_killed_leaves_no_hole(shared_stack: Stack) -> None:
    report = measure_on(shared_stack, 3, seed=4)
    assert not report.problems, report.table()
    assert report.rows > 0


def ask(data: Path, question: str) -> set[tuple[str, ...]]:
    with closing(sqlite3.connect(f"file:{data / 'mucat.db'}?mode=ro", uri=True)) as database:
        return set(database.execute(question))


def wait_for(row: tuple[str, ...], data: Path, question: str) -> None:
    end = time.monotonic() + SECONDS
    while row not in ask(data, question):
        assert time.monotonic() < end, f"no {row}"
        time.sleep(0.05)


def test_a_killed_process_is_replaced_and_the_session_continues(shared_stack: Stack) -> None:
    stack, data = shared_stack, shared_stack.data
    answer = stack.api.post("/sessions", json={"name": "parts"})
    assert answer.status_code == 201, answer.text
    session = answer.json()["id"]
    of_session = f"WHERE session_id = {session}"
    for part, topic in (("simulator", "truth"), ("runtime", "state")):
        wait_for((topic,), data, f"SELECT DISTINCT topic FROM chunk {of_session}")
        psutil.Process(json.loads((data / "run" / f"{part}.pid").read_text())["pid"]).kill()
        wait_for((topic, "restarted"), data, f"SELECT topic, kind FROM gap {of_session}")
    stack.wait_ready()
    assert stack.api.get(f"/sessions/{session}").json()["state"] == "recording"
    stack.api.post(f"/sessions/{session}/stop").raise_for_status()
    assert ask(data, f"SELECT kind FROM gap {of_session}") == {("restarted",)}
