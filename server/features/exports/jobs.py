"""Export jobs: they run one after the other, each in its own process; their files are stored for some days.

The folder holds the description `<id>.json` of each job, and the file `<id>` of one that is done. A job names
its session by the identifier. The description is written first, and the file gets its name last: a killed
server leaves no half file under that name, and the next start lists the job as failed and removes the rest.
"""

import asyncio
import logging
from contextlib import suppress
from datetime import UTC, datetime, timedelta
from pathlib import Path
from secrets import token_hex

from pydantic import ValidationError

from robot_runtime.clock import Clock
from robot_runtime.durable_files import PART, make_folder, write_whole
from robot_runtime.errors import RefusedError
from server.features.exports.description import file_name
from server.features.exports.export_process import ExportProcess, ExportProcessError
from server.features.exports.files import put_in_place
from server.features.exports.formats import check
from server.features.exports.schemas import ExportOptions, Job, NewExport
from server.features.exports.selection import ExportSelection
from server.platform.disk_space import FileWriteError, explain_write_error, require_free
from server.platform.errors import NotFoundError
from server.platform.models import SessionRow
from server.platform.settings import DataFolder
from server.platform.store import Store
from server.platform.wall_clock import WallClock

log = logging.getLogger(__name__)

RETENTION_DAYS = 7
JOBS_MAX, OPERATORS_ONLY = 200, 50
"""Waiting, running and stored; of these places so many are for operators alone."""
CLEAN_SECONDS = 3600.0
DESCRIBED = ".json"
ENDED = "The server ended before the file was complete. Export the session again."
GONE = "The file is no longer there. Export the session again."
PURGED_WAITING = "The session was purged before its export began."
PURGED_RUNNING = "The session was purged before the file was complete, so there is none."


class UnknownExportError(NotFoundError):
    """There is no such export"""


class Jobs:
    """All exports of a server. Methods that use the disk block only briefly.

    For a day after a jump of the wall clock no file is deleted for its age, since that is unknown.
    """

    def __init__(self, folder: DataFolder, store: Store, clock: Clock) -> None:
        self._folder = folder.exports
        self._database = store.location
        self._store = store
        self._wall_clock = WallClock(clock, folder.wall_clock)
        self._jobs: dict[str, Job] = {}
        self._wake = asyncio.Event()
        self._running: tuple[str, ExportProcess] | None = None

    def open(self) -> None:
        """Find the files of earlier servers, and remove unfinished ones."""
        try:
            make_folder(self._folder)
            for path in self._folder.iterdir():
                if path.suffix == DESCRIBED:
                    self._find(path)
            done = [job.id for job in self._jobs.values() if job.state == "done"]
            for path in self._folder.iterdir():
                name = path.name.removesuffix(DESCRIBED)
                if name not in self._jobs or (path.name == name and name not in done):
                    path.unlink()
        except OSError as problem:
            log.warning("the exports in %s cannot be read: %s", self._folder, problem)

    def list(self) -> list[Job]:
        """Return all jobs, newest first."""
        return sorted(self._jobs.values(), key=lambda job: job.made, reverse=True)

    def find(self, job: str) -> Job:
        """Return the job of this name. Raise UnknownExportError."""
        if job not in self._jobs:
            raise UnknownExportError(f"There is no export {job}; choose one from the list of exports.")
        return self._jobs[job]

    def path(self, job: Job) -> Path:
        """Return the path of a job's file."""
        return self._folder / job.id

    async def add(self, row: SessionRow, options: NewExport, most: int = JOBS_MAX) -> Job:
        """Queue an export, where there are fewer than `most`.

        Raise ExportRequestError for options that do not fit, RefusedError if there are too many jobs, and
        FileWriteError if the disk is full.
        """
        plain = ExportOptions.model_validate(options.model_dump(exclude={"session"}))
        kind = check(plain)
        source = await asyncio.to_thread(ExportSelection, self._store, row, plain)
        kind.require(source)
        if len(self._jobs) >= most:
            raise RefusedError(f"There are {most} exports already. Delete some first.")
        require_free(self._folder.parent, 0)
        job = Job(
            id=token_hex(8),
            session=options.session,
            identifier=row.identifier,
            session_name=row.name,
            wanted=plain,
            state="waiting",
            progress=0.0,
            made=datetime.now(UTC),
            file=file_name(source, kind.ending),
        )
        self._jobs[job.id] = job
        try:
            await asyncio.to_thread(self._describe, job)
        except BaseException:
            self._jobs.pop(job.id, None)
            raise
        self._wake.set()
        return job

    def see_purged(self, session: int) -> None:
        """End the exports of a session that is being purged; finished files stay."""
        for job in [job for job in self._jobs.values() if job.session == session]:
            if job.state == "waiting":
                self._change(job.id, state="failed", problem=PURGED_WAITING)
            elif self._running is not None and self._running[0] == job.id:
                self._running[1].cancel(PURGED_RUNNING)

    def remove(self, job: Job) -> None:
        """Cancel a job, or delete its file. Raise RefusedError if that fails."""
        if self._running is not None and self._running[0] == job.id:
            self._running[1].cancel()
        try:
            self._unlink(job)
        except OSError as problem:
            raise RefusedError(
                f"The export cannot be deleted. {explain_write_error(problem, self.path(job))}"
            ) from problem
        del self._jobs[job.id]

    async def run(self) -> None:
        """Run the jobs one after the other; delete expired files."""
        while True:
            self.delete_old(datetime.now(UTC))
            waiting = [job for job in self._jobs.values() if job.state == "waiting"]
            if waiting:
                await self._make(waiting[0].id)
                continue
            self._wake.clear()
            try:
                async with asyncio.timeout(CLEAN_SECONDS):
                    await self._wake.wait()
            except TimeoutError:
                continue

    async def _make(self, number: str) -> None:
        job = self._jobs[number]
        part = self._folder / (number + PART)
        source = str(self._database), job.identifier
        arguments = ["write", *source, job.wanted.model_dump_json(), str(part)]
        child = ExportProcess(arguments, lambda share: self._change(number, progress=share))
        self._running = number, child
        self._change(number, state="running")
        try:
            written = await child.run()
            done = job.model_copy(update={"state": "done", "progress": 1.0, **written})
            await asyncio.to_thread(self._describe, done)
            await asyncio.to_thread(put_in_place, part, self.path(done))
            if number in self._jobs:
                self._jobs[number] = done
            else:
                self._unlink(done)
        except (ExportProcessError, FileWriteError) as problem:
            self._change(number, state="failed", problem=str(problem))
        except OSError as problem:
            self._change(number, state="failed", problem=explain_write_error(problem, self.path(job)))
        finally:
            self._running = None
            # What cannot be deleted now is deleted at the next start; the jobs that wait go on.
            with suppress(OSError):
                await asyncio.to_thread(part.unlink, missing_ok=True)
            if number in self._jobs and self._jobs[number].state == "failed":
                # Where it cannot be written, the next server tells another reason.
                with suppress(FileWriteError):
                    await asyncio.to_thread(self._describe, self._jobs[number])

    def _describe(self, job: Job) -> None:
        described = self._description(job)
        try:
            make_folder(self._folder)
            write_whole(described, job.model_dump_json().encode())
        except OSError as problem:
            raise FileWriteError(explain_write_error(problem, described)) from problem

    def _unlink(self, job: Job) -> None:
        self.path(job).unlink(missing_ok=True)
        self._description(job).unlink(missing_ok=True)

    def _change(self, job: str, **changes: object) -> None:
        if job in self._jobs:
            self._jobs[job] = self._jobs[job].model_copy(update=changes)

    def _find(self, described: Path) -> None:
        try:
            job = Job.model_validate_json(described.read_bytes())
        except (ValidationError, OSError):
            return
        if job.id != described.stem:
            return
        if job.state in ("waiting", "running"):
            job = job.model_copy(update={"state": "failed", "problem": ENDED})
        elif job.state == "done" and not self.path(job).is_file():
            job = job.model_copy(update={"state": "failed", "problem": GONE})
        self._jobs[job.id] = job

    def delete_old(self, now: datetime) -> None:
        """Delete expired files."""
        if not self._wall_clock.knows_ages(now.timestamp()):
            return
        limit = now - timedelta(days=RETENTION_DAYS)
        for job in [
            job for job in self._jobs.values() if job.made < limit and job.state in ("done", "failed")
        ]:
            try:
                self.remove(job)
            except RefusedError as problem:
                log.warning("%s", problem)

    def _description(self, job: Job) -> Path:
        return self._folder / (job.id + DESCRIBED)
