"""The pull of sessions from robots into a lab's archive: whole, once, and only while they are disarmed."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path
from secrets import token_hex
from tempfile import TemporaryDirectory
from threading import Barrier, Event, Semaphore
from typing import Any

import httpx
import pytest
from sqlmodel import col, select

from server.features.exports.archive_reader import ArchiveError
from server.features.exports.imports import Imports
from server.features.lab import pull as pull_module
from server.features.lab import robot_client
from server.features.lab.pull import LOOKS_AT_ONCE, SessionPull
from server.features.lab.robot_client import RobotAnswerError, RobotClient
from server.http.pinned_requests import UnreachableError
from server.http.sign_in.access import Access
from server.http.sign_in.identity import SHELL
from server.library.bookmarks import Bookmarks
from server.library.catalogue import Catalogue
from server.library.content import Recording
from server.library.schemas import SessionEdits
from server.platform.database_copies import sum_file
from server.platform.disk_space import FileWriteError
from server.platform.models import Chunk, PulledSessionRow
from server.platform.paired_robots import PairedRobot, PairedRobots
from server.platform.settings import DataFolder, Settings, make_folders
from server.platform.store import Reader, Store
from tests.server.blocks import depth_block, film_block
from tests.server.features.exports.recordings import record_batches
from tests.server.features.lab.labs import ServedLab, serve_lab
from tests.server.features.lab.pulled_robot import PulledRobot, saying_state
from tests.server.postgres import new_archive
from tests.server.serving import Served, serve
from tests.server.waiting import SECONDS, until


@pytest.fixture
async def robot(settings: Settings) -> AsyncIterator[PulledRobot]:
    """A disarmed robot with a recorded session of two minutes, with a film."""
    async with serve(settings) as served, saying_state(served) as robot:
        await record(robot, "first")
        yield robot


@asynccontextmanager
async def lab_of(settings: Settings, archive: str = "") -> AsyncIterator[ServedLab]:
    """A lab with a folder of its own."""
    with TemporaryDirectory(prefix="mucat-lab-") as name:
        folder = DataFolder(Path(name))
        make_folders(folder)
        async with serve_lab(replace(settings, data=folder), archive) as lab:
            yield lab


async def record(served: Served, name: str) -> int:
    """Record a session of two minutes in twelve chunks, with a film, a bookmark and a tag."""
    batches = [[depth_block(500 * part, 500)] for part in range(12)]
    film = [film_block(number, 101.0 + number, b"picture") for number in range(3)]
    session = await record_batches(served.get(Store), served.settings, *batches, film, name=name)
    await served.get(Bookmarks).add(session, 0.0, "turned")
    await served.get(Catalogue).change(session, tags=["pool"])
    return session


def url_of(robot: PulledRobot) -> str:
    return f"http://127.0.0.1:{robot.settings.server.port}"


async def introduce(lab: ServedLab, robot: PulledRobot, **values: str) -> None:
    """Have a robot join the lab, as by a code."""
    await asyncio.to_thread(lab.get(PairedRobots).add, await pair(robot, **values))


async def pair(robot: PulledRobot, **values: str) -> PairedRobot:
    """Return the lab's entry of a robot that has joined."""
    _, token = await robot.get(Access).make_lab(f"Lab {token_hex(4)}", SHELL)
    joined = {"name": "tested", "address": url_of(robot), "fingerprint": "", "token": token} | values
    return PairedRobot(**joined, joined=0.0)


async def see(lab: ServedLab, phase: str) -> dict[str, Any]:
    """Wait until the pull from the one robot is in a phase; return its description."""
    pull = lab.get(SessionPull)
    await until(lambda: [robot.phase for robot in pull.listed()] == [phase], f"the phase {phase}")
    (robot,) = (await lab.api.get("/lab/pulls")).json()
    assert isinstance(robot, dict)
    return robot


def rows_of(store: Reader, session: int) -> bytes:
    return b"".join(Recording.open(store, session).rows("depth"))


@pytest.mark.parametrize("database", ["sqlite", "postgresql"])
async def test_a_session_comes_whole_and_the_robot_is_told(robot: PulledRobot, database: str) -> None:
    async with lab_of(robot.settings, new_archive() if database == "postgresql" else "") as lab:
        await introduce(lab, robot)
        await see(lab, "done")
        (there,) = (await robot.api.get("/sessions")).json()
        (here,) = (await lab.api.get("/sessions?robot=tested&tag=pool&search=FIRST")).json()
        same = ("identifier", "name", "note", "tags", "markers", "origin", "samples", "robot", "film")
        assert {name: here[name] for name in same} == {name: there[name] for name in same}
        assert there["archived"] is not None
        assert (await lab.api.get("/sessions/robots")).json() == ["tested"]
        assert rows_of(lab.get(Store), here["id"]) == rows_of(robot.get(Store), there["id"])
        film = (await lab.api.get(f"/sessions/{here['id']}/film")).json()
        assert film == (await robot.api.get(f"/sessions/{there['id']}/film")).json()
        # Two minutes in two chunks instead of twelve, and the film's as it was.
        with lab.get(Store).read() as store:
            chunks = store.exec(select(Chunk.count).where(col(Chunk.topic) == "depth")).all()
        assert sum(chunks) == 6000
        assert len(chunks) == 2
        assert (await robot.api.get("/exports")).json() == []


async def test_nothing_comes_twice_not_even_what_was_purged(robot: PulledRobot) -> None:
    async with lab_of(robot.settings) as lab:
        await introduce(lab, robot)
        await see(lab, "done")
        (here,) = (await lab.api.get("/sessions")).json()
        await lab.api.delete(f"/sessions/{here['id']}")
        await lab.api.post(f"/sessions/{here['id']}/purge")
        await record(robot, "second")
        lab.get(SessionPull).wake()
        listing = lab.get(Catalogue)
        await until(
            lambda: [session.name for session in listing.page().sessions] == ["second"], "the second session"
        )
        await see(lab, "done")


@pytest.mark.parametrize("database", ["sqlite", "postgresql"])
async def test_edits_on_the_robot_follow_and_replace_none_of_the_lab_s(
    robot: PulledRobot, database: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def edits_in(lab: ServedLab) -> int:
        with lab.get(Store).read() as store:
            return store.exec(select(PulledSessionRow.edits)).one()

    async def follow(lab: ServedLab) -> dict[str, Any]:
        (edited,) = robot.get(Catalogue).edits(None)
        lab.get(SessionPull).wake()
        await until(lambda: edits_in(lab) == edited.edits, "the edits")
        (here,) = (await lab.api.get("/sessions")).json()
        detail = (await lab.api.get(f"/sessions/{here['id']}")).json()
        assert isinstance(detail, dict)
        return detail

    async with lab_of(robot.settings, new_archive() if database == "postgresql" else "") as lab:
        await introduce(lab, robot)
        await see(lab, "done")
        (there,) = (await robot.api.get("/sessions")).json()
        (here,) = (await lab.api.get("/sessions")).json()
        theirs, ours = f"/sessions/{there['id']}", f"/sessions/{here['id']}"
        # No samples are fetched again.
        monkeypatch.delattr(RobotClient, "begin_export")

        await robot.api.patch(theirs, json={"name": "renamed", "tags": ["sea"]})
        made = await robot.api.post(f"{theirs}/markers", json={"time": 0.0, "text": "lost the light"})
        made.raise_for_status()
        seen = await follow(lab)
        assert (seen["name"], seen["tags"]) == ("renamed", ["sea"])
        assert [(mark["time"], mark["text"]) for mark in seen["marks"]] == [
            (0.0, "turned"),
            (0.0, "lost the light"),
        ]

        await lab.api.patch(ours, json={"name": "of the lab"})
        await robot.api.patch(theirs, json={"name": "of the robot", "note": "windy"})
        mark = (await robot.api.get(theirs)).json()["marks"][0]["id"]
        await robot.api.delete(f"{theirs}/markers/{mark}")
        seen = await follow(lab)
        assert (seen["name"], seen["note"], seen["tags"]) == ("of the lab", "windy", ["sea"])
        assert [mark["text"] for mark in seen["marks"]] == ["lost the light"]

        await robot.api.delete(theirs)
        await robot.api.post(f"{theirs}/purge")
        lab.get(SessionPull).wake()
        assert (await see(lab, "done"))["sessions"] == 1


async def test_what_is_in_the_robot_s_bin_comes_once_it_is_restored(robot: PulledRobot) -> None:
    (there,) = (await robot.api.get("/sessions")).json()
    await robot.api.delete(f"/sessions/{there['id']}")
    async with lab_of(robot.settings) as lab:
        await introduce(lab, robot)
        assert (await see(lab, "done"))["sessions"] == 0
        await robot.api.post(f"/sessions/{there['id']}/restore")
        lab.get(SessionPull).wake()
        await until(lambda: lab.get(Catalogue).page().total == 1, "the session")


async def test_robots_that_are_away_delay_no_other(
    robot: PulledRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    together, blocked, over = Barrier(LOOKS_AT_ONCE), Semaphore(0), Event()
    sessions = RobotClient.sessions

    def look(self: RobotClient) -> list[SessionEdits]:
        name = self._robot.name
        if name == "tested":
            return sessions(self)
        if name not in absent:
            absent.add(name)
            together.wait(SECONDS)
        else:
            blocked.release()
            over.wait()
        raise RobotAnswerError("It does not answer.")

    absent: set[str] = set()
    monkeypatch.setattr(RobotClient, "sessions", look)
    async with lab_of(robot.settings) as lab:
        for number in range(LOOKS_AT_ONCE):
            away = PairedRobot(
                name=f"away {number}", address=url_of(robot), fingerprint="", token=token_hex(4), joined=0.0
            )
            await asyncio.to_thread(lab.get(PairedRobots).add, away)
        await introduce(lab, robot)
        pull = lab.get(SessionPull)

        def phases() -> set[tuple[bool, str]]:
            return {(entry.robot == "tested", entry.phase) for entry in pull.listed()}

        await until(lambda: phases() == {(False, "unreachable"), (True, "done")}, "a look at each")
        pull.wake()
        for _ in range(LOOKS_AT_ONCE):
            await asyncio.to_thread(blocked.acquire)
        await record(robot, "second")
        pull.wake()
        await until(lambda: lab.get(Catalogue).page().total == 2, "the second session")
        over.set()


async def test_an_armed_robot_is_left_alone(robot: PulledRobot) -> None:
    await robot.tell(armed=True)
    async with lab_of(robot.settings) as lab:
        await introduce(lab, robot)
        assert (await see(lab, "armed"))["lacking"] == 1
        assert (await robot.api.get("/exports")).json() == []
        await robot.tell(armed=False)
        lab.get(SessionPull).wake()
        await see(lab, "done")


async def test_a_download_goes_on_where_it_broke_off(
    robot: PulledRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    received: list[int] = []

    def break_off(_: str, answer: Any, __: int) -> bytes:
        if received and not healed:
            raise UnreachableError("The connection broke.")
        piece = answer.read(1000)
        received.append(len(piece))
        return bytes(piece)

    healed = False
    monkeypatch.setattr(robot_client, "read_piece", break_off)
    async with lab_of(robot.settings) as lab:
        await introduce(lab, robot)
        assert "broke" in (await see(lab, "unreachable"))["text"]
        (export,) = (await robot.api.get("/exports")).json()
        (part,) = lab.container.settings.data.pulls.iterdir()
        assert 0 < part.stat().st_size < export["bytes"]
        healed = True
        lab.get(SessionPull).wake()
        await see(lab, "done")
        assert sum(received) == export["bytes"]
        assert [*lab.container.settings.data.pulls.iterdir()] == []


async def test_a_damaged_download_is_fetched_again(
    robot: PulledRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pull_module, "sum_file", lambda path: sum_file(path)[::-1])
    async with lab_of(robot.settings) as lab:
        await introduce(lab, robot)
        assert "damaged on its way" in (await see(lab, "unreachable"))["text"]
        monkeypatch.undo()
        lab.get(SessionPull).wake()
        await see(lab, "done")


async def test_what_cannot_be_read_is_said_and_hinders_no_other(
    robot: PulledRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    take = Imports.take_merged
    refused: list[Path] = []

    async def take_but_the_first(self: Imports, path: Path) -> int:
        if not refused:
            refused.append(path)
            raise ArchiveError("It has format 2; this version of µ-CAT reads format 1.")
        return await take(self, path)

    await record(robot, "second")
    monkeypatch.setattr(Imports, "take_merged", take_but_the_first)
    async with lab_of(robot.settings) as lab:
        await introduce(lab, robot)
        seen = await see(lab, "failed")
        assert (seen["lacking"], "format 2" in seen["problems"][0]) == (1, True)
        assert [session["name"] for session in (await lab.api.get("/sessions")).json()] == ["first"]
        archived = {
            session["name"]: session["archived"] for session in (await robot.api.get("/sessions")).json()
        }
        assert (archived["first"] is not None, archived["second"]) == (True, None)


async def test_a_full_disk_a_wrong_token_and_a_robot_that_is_away_are_said(
    robot: PulledRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise FileWriteError("The disk that holds the archive has 1 MB free.")

    monkeypatch.setattr(pull_module, "require_free", refuse)
    async with lab_of(robot.settings) as lab:
        await introduce(lab, robot)
        assert "1 MB free" in (await see(lab, "failed"))["text"]
        monkeypatch.undo()
        robots = lab.get(PairedRobots)
        for phase, reason, values in (
            ("failed", "lets this lab in no more", {"token": "mucat_wrong"}),
            ("unreachable", "does not answer", {"address": "http://127.0.0.1:1"}),
            ("unreachable", "open to no other computer", {"address": ""}),
        ):
            await asyncio.to_thread(robots.remove, "tested")
            await introduce(lab, robot, **values)
            assert reason in (await see(lab, phase))["text"]


async def test_a_robot_that_has_moved_is_pulled_from_at_its_new_address(robot: PulledRobot) -> None:
    async with lab_of(robot.settings) as lab:
        await introduce(lab, robot, address="http://127.0.0.1:1")
        await see(lab, "unreachable")
        await asyncio.to_thread(lab.get(PairedRobots).move, "tested", url_of(robot), "")
        assert (await see(lab, "done"))["sessions"] == 1


async def test_the_pull_from_a_robot_ends_with_its_removal(
    robot: PulledRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun, removed = Event(), Event()

    def read_slowly(_: str, answer: Any, __: int) -> bytes:
        begun.set()
        assert removed.wait(SECONDS)
        return bytes(answer.read(100))

    monkeypatch.setattr(robot_client, "read_piece", read_slowly)
    async with lab_of(robot.settings) as lab:
        await introduce(lab, robot)
        assert await asyncio.to_thread(begun.wait, SECONDS)
        (pulled,) = (await lab.api.get("/lab/pulls")).json()
        assert (pulled["phase"], pulled["lacking"]) == ("pulling", 1)
        (await lab.api.delete("/robots/tested")).raise_for_status()
        removed.set()
        pulls = lab.container.settings.data.pulls
        await until(lambda: not pulls.exists(), "the end of the download")
        assert (await lab.api.get("/lab/pulls")).json() == []
        assert (await lab.api.get("/sessions")).json() == []
        devices = robot.get(Access).devices
        await until(lambda: [device.kind for device in devices.all()] == [], "the end of the token")


async def test_two_labs_pull_from_one_robot(robot: PulledRobot) -> None:
    async with lab_of(robot.settings) as first, lab_of(robot.settings) as second:
        for lab in (first, second):
            await introduce(lab, robot)
        for lab in (first, second):
            async with asyncio.timeout(SECONDS):
                while len((await lab.api.get("/sessions")).json()) < 1:
                    lab.get(SessionPull).wake()
                    await asyncio.sleep(0.05)
        # What one of them removes stays at the other, and on the robot.
        (here,) = (await first.api.get("/sessions")).json()
        await first.api.delete(f"/sessions/{here['id']}")
        for server in (second, robot):
            assert len((await server.api.get("/sessions")).json()) == 1


async def test_a_lab_reads_stops_and_fetches_and_does_nothing_else(robot: PulledRobot) -> None:
    device, token = await robot.get(Access).make_lab("Lab", SHELL)
    headers = {"authorization": f"Bearer {token}"}
    async with httpx.AsyncClient(base_url=robot.api.base_url, headers=headers) as lab:
        for method, path, body, status in (
            ("GET", "/robot", None, 200),
            ("POST", "/robot/stop", None, 204),
            ("POST", "/sessions/archived", {"identifiers": ["0" * 32]}, 204),
            ("DELETE", f"/exports/{'0' * 16}", None, 404),
            ("POST", "/control/take", None, 403),
            ("PATCH", "/sessions/1", {"name": "mine"}, 403),
            ("DELETE", "/sessions/1", None, 403),
            ("POST", "/access/codes", {}, 403),
        ):
            answer = await lab.request(method, path, json=body)
            assert answer.status_code == status, path
    promoted = await robot.api.patch(f"/access/devices/{device.id}", json={"role": "operator"})
    assert (promoted.status_code, "is a lab" in promoted.json()["detail"]) == (409, True)


async def test_a_token_that_only_reads_cannot_say_that_sessions_are_archived(robot: PulledRobot) -> None:
    asked = {"name": "reader", "scope": "read", "days": 30}
    made = await robot.api.post("/access/tokens", json=asked)
    headers = {"authorization": f"Bearer {made.json()['token']}"}
    async with httpx.AsyncClient(base_url=robot.api.base_url, headers=headers) as reader:
        answer = await reader.post("/sessions/archived", json={"identifiers": ["0" * 32]})
    assert answer.status_code == 403
