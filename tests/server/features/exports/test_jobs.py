import asyncio
import hashlib
import signal
import sys
import time
import zipfile
from datetime import UTC, datetime, timedelta
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from httpx import AsyncClient
from sqlalchemy import update

from robot_runtime.clock import SimulatedClock
from robot_runtime.durable_files import PART
from server.features.exports import export_process
from server.features.exports import jobs as jobs_module
from server.features.exports.jobs import JOBS_MAX, OPERATORS_ONLY, RETENTION_DAYS, Jobs
from server.features.exports.schemas import ExportOptions, Job, NewExport
from server.library.retention import RetentionWorker
from server.platform.models import SessionRow
from server.platform.settings import Settings
from server.platform.store import Store
from server.platform.wall_clock import DAY, WallClock
from server.processes import side_process
from server.recording.session import find_row
from tests.server.blocks import debug_block, depth_block
from tests.server.features.exports.recordings import record
from tests.server.new_database import new_store
from tests.server.serving import Served, serve
from tests.server.waiting import until


@pytest.fixture
def session(settings: Settings) -> int:
    with new_store(settings.data) as store:
        return record(store, settings, [depth_block(0, 5000), debug_block(0, "a", "b")])


async def start(api: AsyncClient, session: int, **expected: Any) -> dict[str, Any]:
    answer = await api.post("/exports", json={"session": session, "format": "csv", **expected})
    assert answer.status_code == 201, answer.text
    job: dict[str, Any] = answer.json()
    return job


async def ended(served: Served, job: dict[str, Any]) -> dict[str, Any]:
    result = served.get(Jobs).find
    await until(lambda: result(job["id"]).state in ("done", "failed"), "the file", 60)
    answer: dict[str, Any] = (await served.api.get(f"/exports/{job['id']}")).json()
    return answer


async def test_an_export_is_written_with_a_checksum_downloaded_in_ranges_and_deleted(
    settings: Settings, session: int, served: Served
) -> None:
    api = served.api
    job = await start(api, session)
    assert (job["session_name"], job["sha256"]) == ("Dive no. 1: Öresund/../x", None)
    job = await ended(served, job)
    assert (job["state"], job["progress"], job["problem"]) == ("done", 1.0, "")
    assert [export["id"] for export in (await api.get("/exports")).json()] == [job["id"]]

    url = f"/exports/{job['id']}/file"
    half = job["bytes"] // 2
    async with api.stream("GET", url) as response:
        assert response.headers["etag"] == f'"{job["sha256"]}"'
        assert job["file"] in response.headers["content-disposition"]
        first = b""
        async for piece in response.aiter_raw(1000):
            first += piece
            if len(first) >= half:
                break
    again = {"range": f"bytes={len(first)}-", "if-range": f'"{job["sha256"]}"'}
    rest = await api.get(url, headers=again)
    assert rest.status_code == 206
    whole = first + rest.content
    assert (len(whole), hashlib.sha256(whole).hexdigest()) == (job["bytes"], job["sha256"])
    with zipfile.ZipFile(settings.data.exports / job["id"]) as archive:
        assert set(archive.namelist()) == {"session.json", "depth.csv", "debug.csv"}
    other = await api.get(url, headers={**again, "if-range": '"another file"'})
    assert (other.status_code, other.content) == (200, whole)

    assert (await api.delete(f"/exports/{job['id']}")).status_code == 204
    assert (await api.get(url)).status_code == 404
    assert list(settings.data.exports.iterdir()) == []


def finished(settings: Settings, name: str, made: datetime) -> Job:
    """Return an export file of an earlier server."""
    content = name.encode()
    job = Job(
        id=name,
        session=1,
        session_name="dive",
        wanted=ExportOptions(format="mcap"),
        state="done",
        progress=1.0,
        made=made,
        file="dive.mcap",
        bytes=len(content),
        sha256=hashlib.sha256(content).hexdigest(),
    )
    folder = settings.data.exports
    folder.mkdir(exist_ok=True)
    (folder / name).write_bytes(content)
    (folder / f"{name}.json").write_text(job.model_dump_json())
    return job


async def test_exports_outlive_the_server_and_unfinished_files_are_deleted(settings: Settings) -> None:
    job = finished(settings, "e" * 16, datetime.now(UTC))
    folder = settings.data.exports
    (folder / ("a" * 16 + ".part")).write_bytes(b"half")
    (folder / ("b" * 16 + ".json")).write_text(job.model_copy(update={"id": "b" * 16}).model_dump_json())
    (folder / ("c" * 16)).write_bytes(b"without a description")
    (folder / ("d" * 16 + ".json")).write_text("{")

    async with serve(settings) as served:
        lost, done = sorted((await served.api.get("/exports")).json(), key=lambda export: export["id"])
        assert done == job.model_dump(mode="json")
        assert (lost["id"], lost["state"], lost["problem"]) == ("b" * 16, "failed", jobs_module.GONE)
        answer = await served.api.get(f"/exports/{job.id}/file")
        assert (answer.content, answer.headers["etag"]) == (b"e" * 16, f'"{job.sha256}"')
        assert {path.name for path in folder.iterdir()} == {job.id, f"{job.id}.json", f"{'b' * 16}.json"}


async def test_old_exports_are_deleted(settings: Settings) -> None:
    limit = datetime.now(UTC) - timedelta(days=RETENTION_DAYS)
    finished(settings, "a" * 16, limit - timedelta(minutes=1))
    young = finished(settings, "b" * 16, limit + timedelta(minutes=10))

    async with serve(settings) as served:
        jobs = served.get(Jobs)
        await until(lambda: len(jobs.list()) == 1, "the old file to go")
        names = {path.name for path in settings.data.exports.iterdir()}
        assert names == {young.id, f"{young.id}.json"}


def test_a_jump_of_the_clock_deletes_no_export(settings: Settings, store: Store) -> None:
    now = datetime.now(UTC)
    old = finished(settings, "a" * 16, now)
    clock = SimulatedClock(50.0)
    jobs = Jobs(settings.data, store, clock)
    jobs.open()
    jobs.delete_old(now)
    later = now + timedelta(days=3650)
    jobs.delete_old(later)
    assert jobs.list() == [old]
    clock.forward(DAY)
    jobs.delete_old(later + timedelta(days=1))
    assert jobs.list() == []


def test_a_jump_of_the_clock_before_a_restart_deletes_no_export(settings: Settings, store: Store) -> None:
    now = datetime.now(UTC)
    old = finished(settings, "a" * 16, now)
    clock = SimulatedClock(50.0)
    before = WallClock(clock, settings.data.wall_clock)
    assert before.knows_ages(now.timestamp())
    before.store()
    jobs = Jobs(settings.data, store, clock)
    jobs.open()
    jobs.delete_old(now + timedelta(days=365))
    assert jobs.list() == [old]


async def test_a_job_whose_files_cannot_be_written_or_deleted_fails_and_the_next_is_done(
    settings: Settings, session: int, monkeypatch: pytest.MonkeyPatch, served: Served
) -> None:
    jobs, row = served.get(Jobs), find_row(served.get(Store), session)
    ids = iter(["a" * 16, "b" * 16])
    monkeypatch.setattr(jobs_module, "token_hex", lambda _: next(ids))
    (settings.data.exports / f"{'a' * 16}{PART}").mkdir()
    broken = await jobs.add(row, NewExport(session=session, format="csv"))
    following = await jobs.add(row, NewExport(session=session, format="csv"))
    await until(lambda: jobs.find(following.id).state == "done", "the next export")
    assert jobs.find(broken.id).state == "failed"


SLOW = """
import pathlib, sys, time
pathlib.Path(sys.argv[-1]).write_bytes(b"half")
print('{"progress": 0.25}', flush=True)
time.sleep(60)
"""


@pytest.fixture
def slow(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Replace the interpreter by one that writes half a file and then waits."""
    script = tmp_path / "slow"
    script.write_text(f"#!{sys.executable}\n{SLOW}")
    script.chmod(0o755)

    monkeypatch.setattr(side_process, "sys", SimpleNamespace(executable=str(script)))


@pytest.mark.usefixtures("slow")
async def test_the_next_job_starts_after_a_cancelled_one(
    settings: Settings, session: int, monkeypatch: pytest.MonkeyPatch, served: Served
) -> None:
    jobs = served.get(Jobs)
    first, second = await start(served.api, session), await start(served.api, session, format="mcap")
    await until(lambda: jobs.find(first["id"]).progress == 0.25, "progress")
    assert (await served.api.get(f"/exports/{second['id']}")).json()["state"] == "waiting"
    for job in (first, second):
        early = await served.api.get(f"/exports/{job['id']}/file")
        assert (early.status_code, "not finished" in early.json()["detail"]) == (409, True)
    monkeypatch.setattr(side_process, "sys", sys)
    assert (await served.api.delete(f"/exports/{first['id']}")).status_code == 204
    assert (await ended(served, second))["state"] == "done"
    names = {path.name for path in settings.data.exports.iterdir()}
    assert names == {second["id"], f"{second['id']}.json"}


@pytest.mark.usefixtures("slow")
async def test_a_killed_export_process_leaves_no_file(
    settings: Settings, session: int, served: Served
) -> None:
    jobs = served.get(Jobs)
    job = await start(served.api, session)
    await until(lambda: jobs.find(job["id"]).progress == 0.25, "progress")
    assert jobs._running is not None
    process = jobs._running[1]._process
    assert process is not None
    process.signal(signal.SIGKILL)
    job = await ended(served, job)
    assert (job["state"], job["problem"]) == ("failed", "The process for it was ended by signal SIGKILL.")
    await until(lambda: only_described(settings, job), "the half file to go")


def only_described(settings: Settings, job: dict[str, Any]) -> bool:
    return [path.name for path in settings.data.exports.iterdir()] == [f"{job['id']}.json"]


@pytest.mark.usefixtures("slow")
async def test_a_process_without_progress_is_ended(
    settings: Settings, session: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(export_process, "SILENT_SECONDS", 0.3)

    async with serve(settings) as served:
        job = await ended(served, await start(served.api, session))
        assert (job["state"], "made no progress" in job["problem"]) == ("failed", True)


def test_exports_of_a_killed_server_are_listed_as_failed(settings: Settings, store: Store) -> None:
    job = finished(settings, "a" * 16, datetime.now(UTC))
    for name, state in (("b", "waiting"), ("c", "running")):
        other = job.model_copy(update={"id": name * 16, "state": state})
        (settings.data.exports / f"{other.id}.json").write_text(other.model_dump_json())
    (settings.data.exports / ("c" * 16 + PART)).write_bytes(b"half")
    (settings.data.exports / ("b" * 16)).write_bytes(b"not finished")
    jobs = Jobs(settings.data, store, SimulatedClock())
    jobs.open()
    assert {job.id[0]: (job.state, job.problem) for job in jobs.list()} == {
        "a": ("done", ""),
        "b": ("failed", jobs_module.ENDED),
        "c": ("failed", jobs_module.ENDED),
    }
    assert {path.name for path in settings.data.exports.iterdir()} == {
        "a" * 16,
        *(f"{name * 16}.json" for name in "abc"),
    }
    jobs.remove(jobs.find("b" * 16))
    assert not (settings.data.exports / ("b" * 16 + ".json")).exists()


async def purge(served: Served, session: int) -> None:
    """Remove a session for good, and wait until it is gone."""
    assert (await served.api.delete(f"/sessions/{session}")).status_code == 200
    assert (await served.api.post(f"/sessions/{session}/purge")).status_code == 204
    await served.get(RetentionWorker).apply(time.time())


@pytest.mark.usefixtures("slow")
async def test_exports_of_a_purged_session_fail_and_the_next_session_has_another_number(
    settings: Settings, session: int, served: Served
) -> None:
    jobs = served.get(Jobs)
    running, waiting = await start(served.api, session), await start(served.api, session, format="mcap")
    await until(lambda: jobs.find(running["id"]).progress == 0.25, "progress")
    await purge(served, session)
    assert jobs.find(waiting["id"]).state == "failed"
    following = await asyncio.to_thread(record, served.get(Store), settings, [depth_block(0, 10)])
    assert following > session
    texts = [(await ended(served, job))["problem"] for job in (running, waiting)]
    assert texts == [jobs_module.PURGED_RUNNING, jobs_module.PURGED_WAITING]


@pytest.mark.usefixtures("slow")
async def test_a_waiting_export_reads_the_session_of_its_identifier_alone(
    session: int, monkeypatch: pytest.MonkeyPatch, served: Served
) -> None:
    jobs, store = served.get(Jobs), served.get(Store)
    first, second = await start(served.api, session), await start(served.api, session, format="mcap")
    await until(lambda: jobs.find(first["id"]).progress == 0.25, "progress")
    # As a restored database might: the number is another session's.
    await store.execute(update(SessionRow).values(identifier="another"))
    monkeypatch.setattr(side_process, "sys", sys)
    await served.api.delete(f"/exports/{first['id']}")
    assert "was purged" in (await ended(served, second))["problem"]


LIMITED = """#!{python}
import resource, runpy, sys
resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
import signal
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
sys.argv[:] = ["server.features.exports", *sys.argv[3:]]
runpy.run_module("server.features.exports", run_name="__main__")
"""


async def test_a_full_disk_is_reported_and_no_data_is_lost(
    settings: Settings, session: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    script = tmp_path / "limited"
    script.write_text(LIMITED.format(python=sys.executable))
    script.chmod(0o755)

    monkeypatch.setattr(side_process, "sys", SimpleNamespace(executable=str(script)))

    async with serve(settings) as served:
        job = await ended(served, await start(served.api, session, format="mcap"))
        assert job["state"] == "failed"
        assert job["problem"].endswith("is full. Free some space, and try again.")
        await until(lambda: only_described(settings, job), "the half file to go")
        assert (await served.api.get(f"/exports/{job['id']}/file")).status_code == 409
        assert (await served.api.get(f"/sessions/{session}")).json()["samples"] == 5002


@pytest.mark.parametrize(
    ("body", "status", "message"),
    [
        ({"format": "csv"}, 422, "session: Field required"),
        ({"session": 1, "format": "xls"}, 422, "format"),
        ({"session": 1, "format": "csv", "topics": []}, 422, "topics"),
        ({"session": 1, "format": "csv", "topics": ["../x"]}, 422, "no topic ../x"),
        ({"session": 1, "format": "csv-grid", "period": 0}, 422, "period"),
        ({"session": 1, "format": "csv", "start": 2, "end": 1}, 422, "must be after the start"),
        ({"session": 1, "format": "csv", "path": "/etc"}, 422, "path"),
        ({"session": 9, "format": "csv"}, 404, "no session 9"),
    ],
)
async def test_an_impossible_export_is_refused(
    settings: Settings, session: int, body: dict[str, Any], status: int, message: str
) -> None:
    assert session == 1
    async with serve(settings) as served:
        answer = await served.api.post("/exports", json=body)
        assert (answer.status_code, message in answer.json()["detail"]) == (status, True), answer.text
        assert (await served.api.get("/exports")).json() == []


async def test_an_unknown_export_is_not_found(served: Served) -> None:
    for path in ("/exports/" + "0" * 16, "/exports/" + "0" * 16 + "/file"):
        answer = await served.api.get(path)
        assert (answer.status_code, "There is no export" in answer.json()["detail"]) == (404, True)
    for strange in ("x", "..%2f..%2fmucat.db", "0" * 17):
        assert (await served.api.get(f"/exports/{strange}/file")).status_code in (404, 422)


async def test_viewers_leave_places_for_the_exports_of_operators(settings: Settings, session: int) -> None:
    for number in range(JOBS_MAX - OPERATORS_ONLY):
        finished(settings, f"{number:016x}", datetime.now(UTC))

    async with serve(settings) as served:
        program = {"name": "Program", "scope": "read"}
        token = (await served.api.post("/access/tokens", json=program)).raise_for_status().json()["token"]
        output, viewer = {"session": session, "format": "csv"}, {"authorization": f"Bearer {token}"}
        async with AsyncClient(base_url=served.api.base_url, headers=viewer) as client:
            answer = await client.post("/exports", json=output)
        assert (answer.status_code, "Delete some first" in answer.json()["detail"]) == (409, True)
        assert (await served.api.post("/exports", json=output)).status_code == 201


async def test_too_many_exports_are_refused(settings: Settings, session: int) -> None:
    for number in range(JOBS_MAX):
        finished(settings, f"{number:016x}", datetime.now(UTC))

    async with serve(settings) as served:
        answer = await served.api.post("/exports", json={"session": session, "format": "csv"})
        assert (answer.status_code, "Delete some first" in answer.json()["detail"]) == (409, True)
