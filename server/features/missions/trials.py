"""Trials of missions in simulated time, in a process of low priority, one at a time."""

import asyncio
import json
import logging
import os
import sys
from asyncio.subprocess import PIPE, Process
from contextlib import suppress
from dataclasses import asdict

from robot_runtime.errors import RefusedError
from server.features.missions.schemas import MissionTrial, MissionTrialResult
from server.platform.runs import new_run, require_run
from server.platform.settings import Settings
from server.processes.exit_status import describe_status

log = logging.getLogger(__name__)

LINE_BYTES_MAX = 4_000_000
SECONDS_MAX = 1800.0
CANCELLED = "It was cancelled."


class MissionTrials:
    """The running trial and the last one."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._trial = MissionTrial(run="", name="", text="", running=False, seeds=0, problem="", results=[])
        self._task: asyncio.Task[None] | None = None

    def state(self) -> MissionTrial:
        """The running trial, or the last one, with its results so far."""
        return self._trial

    def start(self, name: str, text: str, library: dict[str, str], seeds: int) -> None:
        """Starts a trial. Raises RefusedError while another runs."""
        if self._trial.running:
            raise RefusedError("A trial is running. Wait for its end, or cancel it.")
        trial = self._trial = MissionTrial(
            run=new_run(),
            name=name,
            text=text,
            running=True,
            seeds=seeds,
            problem="",
            results=[],
        )
        self._task = asyncio.create_task(self._perform(trial, library))
        # Also of a task that is cancelled before it begins.
        self._task.add_done_callback(lambda _: setattr(trial, "running", False))

    def cancel(self, run: str | None = None) -> None:
        """Ends the running trial, or this one alone; its results stay. Raises RefusedError, RunOverError."""
        require_run(run, self._trial.run if self._trial.running else None, "trial")
        if self._task is None or not self._trial.running:
            raise RefusedError("No trial is running.")
        self._trial.problem = CANCELLED
        self._task.cancel()

    async def wait(self) -> None:
        """Waits for the end of the running trial."""
        if self._task is not None:
            await asyncio.gather(self._task, return_exceptions=True)

    async def close(self) -> None:
        """Ends the running trial."""
        if self._task is not None:
            self._task.cancel()
            await self.wait()

    async def _perform(self, trial: MissionTrial, library: dict[str, str]) -> None:
        try:
            async with asyncio.timeout(SECONDS_MAX):
                trial.problem = await self._try(trial, library)
        except TimeoutError:
            trial.problem = f"It was given up after {SECONDS_MAX / 60:.0f} min. Choose fewer seeds."
        except OSError as problem:
            trial.problem = f"No process can be started for it ({problem.strerror})."
        except Exception:
            log.exception("a trial of a mission failed")
            trial.problem = "An error in the software ended it; see the server's log."

    async def _try(self, trial: MissionTrial, library: dict[str, str]) -> str:
        process = await asyncio.create_subprocess_exec(
            sys.executable,
            "-m",
            "robot_runtime.experiments.mission_trial",
            "--seeds",
            str(trial.seeds),
            "--craft",
            str(self._settings.craft_file),
            stdin=PIPE,
            stdout=PIPE,
            start_new_session=True,
            limit=LINE_BYTES_MAX,
            env={**os.environ, "MUCAT_BUILD": str(self._settings.build)},
        )
        asked = {"text": trial.text, "library": library, "limits": asdict(self._settings.missions)}
        try:
            return await _follow(process, json.dumps(asked).encode(), trial)
        finally:
            if process.returncode is None:
                with suppress(ProcessLookupError):
                    process.kill()
                await process.wait()


async def _follow(process: Process, asked: bytes, trial: MissionTrial) -> str:
    """Takes the process's results; returns the reason of an early end."""
    assert process.stdin is not None
    assert process.stdout is not None
    with suppress(ConnectionError):
        process.stdin.write(asked)
        await process.stdin.drain()
    process.stdin.close()
    async for line in process.stdout:
        message = json.loads(line)
        if "problems" in message:
            return " ".join(message["problems"])
        trial.results.append(MissionTrialResult.model_validate(message))
    status = await process.wait()
    return "" if status == 0 else f"The simulation {describe_status(status)}."
