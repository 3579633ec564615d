"""The predictions of step responses, made in a process beside the server."""

import asyncio
from dataclasses import asdict

from robot_runtime.config import parse_text
from server.features.tuning.schemas import PredictionQuery
from server.platform.errors import UnavailableError
from server.platform.settings import Settings
from server.processes.task_process import TaskProcess, TaskProcessEndedError

SECONDS_MAX = 60.0
"""Time that a prediction may take: 0.3 s on a desktop computer."""
IDLE_SECONDS = 60.0
"""Time after which the process ends that nobody asks anything."""


class PredictionError(UnavailableError):
    """The step cannot be predicted"""

    def __init__(self, problem: str, status: int = UnavailableError.status) -> None:
        super().__init__(problem)
        self.status = status


class StepPredictor:
    """The process of the predictions: started when needed. It makes one after the other."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._turn = asyncio.Lock()
        self._process: TaskProcess | None = None
        self._idle: asyncio.TimerHandle | None = None
        self._leaving: asyncio.Task[None] | None = None

    async def predict(self, query: PredictionQuery) -> bytes:
        """Return the prediction as JSON. Raise PredictionError."""
        settings = self._settings
        control = parse_text(settings.config_text, settings.config).control
        task = {"query": query.model_dump(), "control": asdict(control)}
        async with self._turn:
            if self._idle is not None:
                self._idle.cancel()
            status, body = await self._ask(task)
            self._idle = asyncio.get_running_loop().call_later(IDLE_SECONDS, self._end_idle)
        if status != 200:
            raise PredictionError(body.decode(), status)
        return body

    async def close(self) -> None:
        """End the process."""
        if self._idle is not None:
            self._idle.cancel()
        if self._leaving is not None:
            await self._leaving
        if self._process is not None:
            await self._process.end()

    async def _ask(self, task: object) -> tuple[int, bytes]:
        try:
            if self._process is None or self._process.ended:
                arguments = (str(self._settings.craft_file), str(self._settings.build))
                self._process = await TaskProcess.start("server.features.tuning", *arguments)
            return await self._process.ask(task, SECONDS_MAX)
        except OSError as problem:
            why = f"no process can be started for it ({problem.strerror})"
        except TimeoutError:
            why = f"it was given up after {SECONDS_MAX:.0f} s"
        except TaskProcessEndedError as end:
            why = f"its process {end}. The computer may lack memory"
        raise PredictionError(f"The step cannot be predicted: {why}.")

    def _end_idle(self) -> None:
        if self._process is not None and not self._turn.locked():
            self._leaving = asyncio.create_task(self._process.end())
            self._process = None
