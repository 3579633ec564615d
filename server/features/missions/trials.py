"""Trials of missions in simulated time, in a process of low priority, one at a time."""

import asyncio
import json
import logging
from dataclasses import asdict

from robot_runtime.errors import RefusedError
from server.features.missions.schemas import MissionTrial, MissionTrialResult
from server.platform.runs import new_run, require_run
from server.platform.settings import Settings
from server.processes.side_process import SideProcess

log = logging.getLogger(__name__)

SECONDS_MAX = 1800.0
CANCELLED = "It was cancelled."


class MissionTrials:
    """The running trial and the last one."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._trial = MissionTrial(run="", name="", text="", running=False, seeds=0, problem="", results=[])
        self._task: asyncio.Task[None] | None = None

    def state(self) -> MissionTrial:
        """Return the running trial, or the last one, with its results so far."""
        return self._trial

    def start(self, name: str, text: str, library: dict[str, str], seeds: int) -> None:
        """Start a trial. Raise RefusedError while another runs."""
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
        """End the running trial, or only this one; its results stay. Raise RefusedError, RunOverError."""
        require_run(run, self._trial.run if self._trial.running else None, "trial")
        if self._task is None or not self._trial.running:
            raise RefusedError("No trial is running.")
        self._trial.problem = CANCELLED
        self._task.cancel()

    async def wait(self) -> None:
        """Wait for the end of the running trial."""
        if self._task is not None:
            await asyncio.gather(self._task, return_exceptions=True)

    async def close(self) -> None:
        """End the running trial."""
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
        """Take the results of the process; return the reason of an early end."""
        arguments = ["--seeds", str(trial.seeds), "--craft", str(self._settings.craft_file)]
        given = {"text": trial.text, "library": library, "limits": asdict(self._settings.mission_limits)}
        with SideProcess(
            "robot_runtime.experiments.mission_trial",
            arguments,
            json.dumps(given).encode(),
            {"MUCAT_BUILD": str(self._settings.build)},
        ) as process:
            async for document in process.documents():
                if "problems" in document:
                    return " ".join(document["problems"])
                trial.results.append(MissionTrialResult.model_validate(document))
            complete = len(trial.results) == trial.seeds
            return "" if complete else f"The simulation {await process.describe_end()}"
