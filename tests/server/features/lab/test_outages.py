"""A lab that is killed, and one whose PostgreSQL goes away: nothing is lost, nothing is there twice."""

import asyncio
import os
import signal
import subprocess
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, closing, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import httpx
import pytest
from sqlalchemy import delete
from sqlmodel import col, func, select

from server.features.exports.imports import Imports
from server.features.lab.pull import SessionPull
from server.library.retention import RetentionWorker
from server.platform.models import Chunk, PulledSessionRow, SessionFiguresRow, SessionRow
from server.platform.paired_robots import PairedRobot, PairedRobots
from server.platform.settings import DataFolder, make_folders
from server.platform.store import Reader, Store
from tests.server.features.lab.killed_lab import POINTS
from tests.server.features.lab.pulled_robot import PulledRobot
from tests.server.features.lab.test_pull import introduce, lab_of, pair, record, robot, rows_of, see
from tests.server.postgres import new_archive, postgres
from tests.server.waiting import SECONDS, until
from tests.shell import ShellAuth
from tests.stack import ROOT, free_port

__all__ = ["robot"]


class LabProcess:
    """A lab in processes of its own."""

    def __init__(self, data: DataFolder, port: int) -> None:
        url = f"http://127.0.0.1:{port}/api"
        self.api = httpx.AsyncClient(base_url=url, timeout=SECONDS, auth=ShellAuth(data))
        self._data, self._port = data, port

    def start(self) -> None:
        """Start it."""
        command = [sys.executable, "-m", "tests.server.features.lab.killed_lab", "lab", "run"]
        environment = os.environ | {"MUCAT_DATA": str(self._data.path)}
        config = ["--config", str(self._data.config), "--port", str(self._port)]
        with (self._data.path / "lab.log").open("wb") as log:
            self.process = subprocess.Popen(
                [*command, *config],
                cwd=ROOT,
                env=environment,
                stdout=log,
                stderr=log,
                start_new_session=True,
            )

    def kill(self) -> None:
        """Kill all of it at once, if anything of it is still there."""
        with suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()

    async def serves(self) -> bool:
        """Return True where it answers."""
        try:
            return (await self.api.get("/health")).status_code == 200
        except httpx.TransportError:
            return False


@asynccontextmanager
async def lab_process(archive: str, robot: PairedRobot) -> AsyncIterator[tuple[LabProcess, DataFolder]]:
    with TemporaryDirectory(prefix="mucat-lab-") as name:
        folder = DataFolder(Path(name))
        make_folders(folder)
        port, router = free_port(), free_port()
        folder.config.write_text(
            f'[robot]\nname = "lab"\n[server]\ntls = false\n[lab]\ndatabase = "{archive}"\n'
            f'[zenoh]\nlisten = ["tls/127.0.0.1:{router}"]\n'
        )
        PairedRobots(folder).add(robot)
        lab = LabProcess(folder, port)
        lab.start()
        try:
            yield lab, folder
        finally:
            await lab.api.aclose()
            lab.kill()


async def wait(condition: Any, what: str) -> None:
    """Wait for a condition of the lab."""
    try:
        async with asyncio.timeout(SECONDS):
            while not await condition():
                await asyncio.sleep(0.05)
    except TimeoutError:
        raise AssertionError(what) from None


async def test_a_lab_that_is_killed_at_every_step_has_everything_once(robot: PulledRobot) -> None:
    await record(robot, "second")
    async with lab_process(new_archive(), await pair(robot)) as (lab, folder):
        await wait(lab.serves, "it does not start")

        async def killed() -> bool:
            return all((folder.path / f"killed-{point}").exists() for point in POINTS)

        await wait(killed, "it was not killed everywhere")

        async def whole() -> bool:
            return await lab.serves() and len(await figures()) == 2 and all(await archived())

        async def figures() -> set[int]:
            with closing(Reader(folder.database_location)) as reader, reader.read() as store:
                return set(store.exec(select(SessionFiguresRow.session_id)))

        async def archived() -> list[bool]:
            return [session["archived"] is not None for session in (await robot.api.get("/sessions")).json()]

        await wait(whole, "it does not go on")
        lab.kill()
        with closing(Reader(folder.database_location)) as reader:
            with reader.read() as store:
                sessions = store.exec(select(SessionRow).order_by(SessionRow.name)).all()
                pulled = store.exec(select(PulledSessionRow.identifier)).all()
                others = store.exec(
                    select(func.count()).where(col(Chunk.session_id).not_in([row.id for row in sessions]))
                ).one()
            assert [(row.name, row.state) for row in sessions] == [
                ("first", "complete"),
                ("second", "complete"),
            ]
            assert sorted(pulled) == sorted(row.identifier for row in sessions)
            assert others == 0
            there = {session["name"]: session["id"] for session in (await robot.api.get("/sessions")).json()}
            for row in sessions:
                assert row.id is not None
                assert rows_of(reader, row.id) == rows_of(robot.get(Store), there[row.name])
        assert [*folder.pulls.iterdir()] == []
        assert (await robot.api.get("/exports")).json() == []


async def test_postgresql_that_goes_away_in_an_import_is_said_and_the_pull_goes_on_by_itself(
    robot: PulledRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    server, fill, stopped = postgres(), Imports._fill_chunks, list[int]()

    async def stop_and_fill(self: Imports, number: int, path: Path) -> dict[str, int]:
        if not stopped:
            stopped.append(number)
            server.stop()
        return await fill(self, number, path)

    async with lab_of(robot.settings, new_archive()) as lab:
        monkeypatch.setattr(Imports, "_fill_chunks", stop_and_fill)
        await introduce(lab, robot)
        store = lab.get(Store)
        try:
            await until(lambda: bool(stopped) and store.failing is not None, "the outage")
            answer = await lab.api.get("/sessions")
            assert (answer.status_code, "PostgreSQL does not answer" in answer.json()["detail"]) == (
                503,
                True,
            )
            health = (await lab.api.get("/health")).json()
            assert [part["state"] for part in health["parts"] if part["name"] == "database"] == ["failed"]
        finally:
            server.start()

        async def pulled() -> bool:
            lab.get(SessionPull).wake()
            lab.get(RetentionWorker).wake()
            answer = await lab.api.get("/sessions")
            return answer.status_code == 200 and [session["name"] for session in answer.json()] == ["first"]

        await wait(pulled, "the session does not come")
        (here,) = (await lab.api.get("/sessions")).json()
        (there,) = (await robot.api.get("/sessions")).json()
        assert rows_of(store, here["id"]) == rows_of(robot.get(Store), there["id"])
        with store.read() as database:
            assert database.exec(select(func.count()).select_from(SessionRow)).one() == 1


async def test_what_a_killed_lab_has_not_noted_is_noted_at_the_next_look_and_does_not_come_back(
    robot: PulledRobot,
) -> None:
    async with lab_of(robot.settings) as lab:
        await introduce(lab, robot)
        await see(lab, "done")
        store = lab.get(Store)
        # As one that is killed between a session and its note.
        await store.execute(delete(PulledSessionRow))

        async def noted() -> bool:
            lab.get(SessionPull).wake()
            with store.read() as database:
                return database.exec(select(func.count()).select_from(PulledSessionRow)).one() == 1

        await wait(noted, "it is not noted")
