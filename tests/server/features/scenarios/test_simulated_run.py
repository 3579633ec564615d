"""Scenarios in simulated time: recorded with a clock of their own, in a queue, cancelled, from the shell."""

import asyncio
import sqlite3
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from robot_runtime.clock import SteadyClock
from robot_runtime.config import RobotConfig
from robot_runtime.experiments.scenario.document import read_scenario
from server.cli import main
from server.features.scenarios import simulated_run
from server.features.scenarios.runs import ScenarioRunner
from server.features.scenarios.schemas import ScenarioState
from server.features.scenarios.simulated_run import SimulatedExecutor
from server.library.content import Recording
from server.platform.notices import Notices
from server.platform.runs import RunOverError
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.session import find_row
from tests.server.waiting import SECONDS

SHORT = """
name = "short"
title = "A short one"
duration = 4
seed = 7
[scene]
kind = "natural"
depth = 3.0
[control]
set_point = 0.2
[[events]]
at = 0.5
do = "arm"
[[events]]
at = 2
do = "card"
colour = "yellow"
"""
LONG = SHORT.replace("duration = 4", "duration = 3600")


@asynccontextmanager
async def simulated(
    settings: Settings, store: Store
) -> AsyncIterator[tuple[ScenarioRunner, list[ScenarioState]]]:
    """The runs of a server without a robot, and their published states."""
    states: list[ScenarioState] = []
    executor = SimulatedExecutor(settings, store, Notices(SteadyClock(), lambda _: None))
    runs = ScenarioRunner(
        executor, executor, lambda message: states.append(ScenarioState.model_validate(message))
    )
    try:
        yield runs, states
    finally:
        await runs.close()


def samples(store: Store, session: int) -> list[Any]:
    row = find_row(store, session)
    recording = Recording(store, row)
    return [
        (topic, [chunk.data for chunk in recording.chunks(topic)]) for topic in sorted(recording.counts())
    ]


async def test_runs_of_one_seed_wait_for_each_other_and_are_the_same(
    settings: Settings, store: Store
) -> None:
    started: list[str] = []

    async with simulated(settings, store) as (runs, states):
        started.extend(runs.start(read_scenario(SHORT), SHORT, "simulated", "host") for _ in range(2))
        assert [queued.run for queued in runs.state().queued] == started[1:]
        await runs.wait()
    ends = {state.last.run: state.last for state in states if state.last}
    assert {run: (end.state, end.problem, end.before) for run, end in ends.items()} == {
        started[0]: ("complete", "", None),
        started[1]: ("complete", "", ends[started[0]].session),
    }
    first, second = (find_row(store, ends[run].session or 0) for run in started)
    assert (first.origin, first.scenario, first.scenario_name, first.seed) == ("simulated", SHORT, "short", 7)
    assert (first.started_steady, first.state) == (0.0, "complete")
    assert len(first.firmware) == len(first.software) == 16
    assert samples(store, first.id or 0) == samples(store, second.id or 0)
    times, columns = Recording(store, first).columns("control", ["set_point"])
    assert times[0] < 0.2
    assert 4.0 < times[-1] <= first.duration < 5.0
    assert sorted({round(float(column), 1) for column in columns["set_point"]}) == [0.2, 1.0]
    with sqlite3.connect(settings.data.database) as database:
        marks = database.execute(f"SELECT time, text FROM marker WHERE session_id = {first.id}").fetchall()
    assert [(round(time), text) for time, text in marks] == [(1, "Arm"), (2, "Yellow card")]


async def test_a_cancelled_run_keeps_its_recording_and_clears_the_queue(
    settings: Settings, store: Store
) -> None:
    async with simulated(settings, store) as (runs, states):
        runs.start(read_scenario(LONG), LONG, "simulated", "host")
        runs.start(read_scenario(LONG), LONG, "simulated", "host")
        while runs.active is None or runs.active.elapsed < 1:
            await asyncio.sleep(0.02)
        runs.cancel()
        await runs.wait()
    last = states[-1]
    assert (last.active, last.queued) == (None, [])
    assert last.last is not None
    assert (last.last.state, last.last.problem) == ("cancelled", "It was cancelled.")
    row = find_row(store, last.last.session or 0)
    assert (row.state, row.samples > 0) == ("complete", True)
    assert row.duration < 3600


async def test_one_run_is_cancelled_alone(settings: Settings, store: Store) -> None:
    started: list[str] = []
    async with simulated(settings, store) as (runs, states):
        first, second, third = (runs.start(read_scenario(LONG), LONG, "simulated", "host") for _ in range(3))
        runs.cancel(second)
        assert runs.active is not None
        assert [queued.run for queued in runs.state().queued] == [third]
        runs.cancel(first)
        while runs.active.run != third:
            await asyncio.sleep(0.02)
        with pytest.raises(RunOverError, match="This run of a scenario is over, or of an earlier start"):
            runs.cancel(first)
        assert runs.active.run == third
        started.extend((first, third))
    ended = [state.last for state in states if state.last]
    assert {record.run: record.problem for record in ended} == dict.fromkeys(started, "It was cancelled.")


async def test_no_run_of_an_earlier_server_is_cancelled(settings: Settings, store: Store) -> None:
    earlier: list[str] = []

    for _ in range(2):
        async with simulated(settings, store) as (runs, _):
            earlier.append(runs.start(read_scenario(LONG), LONG, "simulated", "host"))
            if len(earlier) == 2:
                with pytest.raises(RunOverError):
                    runs.cancel(earlier[0])
                assert runs.active is not None
                assert runs.active.run == earlier[1]


async def test_a_refused_command_gets_a_bookmark_and_a_notice(settings: Settings, store: Store) -> None:
    broken = SHORT + "[[events]]\nat = 0.1\ndo = 'fault'\nsensor = 'pressure'\nkind = 'bus'\n"

    later = broken.replace("at = 0.5", "at = 2.5")

    async with simulated(settings, store) as (runs, states):
        runs.start(read_scenario(later), later, "simulated", "host")
        await runs.wait()
    last = states[-1].last
    assert last is not None
    assert last.state == "complete"
    assert last.problem.startswith("At 2.5 s: Arm: refused. ")


async def test_a_failed_process_is_reported_with_its_output(
    settings: Settings, store: Store, tmp_path: Path
) -> None:
    nowhere = Settings(
        data=settings.data, config=settings.config, robot=RobotConfig(name="tested"), build=tmp_path
    )
    async with simulated(nowhere, store) as (runs, states):
        runs.start(read_scenario(SHORT), SHORT, "simulated", "emulated")
        await runs.wait()
    last = states[-1].last
    assert last is not None
    assert (last.state, last.session) == ("failed", None)
    assert "has ended with exit status" in last.problem
    assert str(tmp_path) in last.problem


async def test_a_process_that_goes_on_writing_after_an_invalid_message_is_ended(
    settings: Settings, store: Store, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script = tmp_path / "python"
    script.write_text(
        f"#!{sys.executable}\nimport sys\nwhile True:\n    sys.stdout.buffer.write(b'\\xff' * 100_000)\n"
    )
    script.chmod(0o700)
    monkeypatch.setattr(simulated_run, "sys", SimpleNamespace(executable=str(script)))
    # The pipe is full at once.
    monkeypatch.setattr(simulated_run, "MESSAGE_BYTES_MAX", 1000)

    async with simulated(settings, store) as (runs, states):
        runs.start(read_scenario(SHORT), SHORT, "simulated", "host")
        async with asyncio.timeout(SECONDS):
            await runs.wait()
    last = states[-1].last
    assert last is not None
    assert "sent a message that is not valid" in last.problem


def test_a_scenario_runs_from_the_shell(
    settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "short.toml"
    file.write_text(SHORT)
    options = ["--data", str(settings.data.path), "--config", str(settings.config)]
    assert main(["scenario", "check", str(file), *options]) == 0
    assert main(["scenario", "run", str(file), *options]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "A short one: 4 s, seed 7"
    assert lines[-2:] == ["     2.0 s  Yellow card", "A short one: complete. Session 1."]
    file.write_text(SHORT.replace("[scene]", "[sea]"))
    assert main(["scenario", "run", str(file), *options]) == 1
    problems = capsys.readouterr().err
    assert "scene is missing" in problems
    assert "'sea' is not known here" in problems
    assert main(["scenario", "run", str(tmp_path / "none.toml"), *options]) == 1
    assert "lost_link" in capsys.readouterr().err
    assert main(["scenario", "list", *options]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 7
