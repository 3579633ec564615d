"""Runs fits for the page, each in a process of its own, one at a time."""

import asyncio
import logging

from robot_runtime.errors import RefusedError
from server.features.identification.adoption import CraftAdoption
from server.features.identification.run import check_choice
from server.features.identification.schemas import (
    ActiveIdentification,
    EndedIdentification,
    IdentificationResult,
    IdentificationStart,
    IdentificationState,
)
from server.platform.errors import explain_internal_error
from server.platform.runs import new_run, require_run
from server.platform.settings import Settings
from server.processes.side_process import SideProcess

log = logging.getLogger(__name__)

SECONDS_MAX = 1800.0
"""Time that a fit may take: a minute on a desktop computer, half an hour on a Raspberry Pi."""
CANCELLED = "It was cancelled."


class IdentificationRunner:
    """The running fit and the last one; `adoption` adopts its craft."""

    def __init__(self, settings: Settings, adoption: CraftAdoption) -> None:
        self._settings = settings
        self._adoption = adoption
        self._active: ActiveIdentification | None = None
        self._last: EndedIdentification | None = None
        self._task: asyncio.Task[None] | None = None

    def state(self) -> IdentificationState:
        """Return the running fit, or the last one with its result, and the craft in force."""
        last = self._last if self._active is None else None
        return IdentificationState(active=self._active, last=last, craft=self._adoption.describe())

    def start(self, choice: IdentificationStart) -> str:
        """Start a fit, and return its run. Raise RefusedError."""
        if self._active is not None:
            raise RefusedError("A fit is running. Wait for its end, or cancel it.")
        check_choice(choice.sessions, choice.left_out)
        run = new_run()
        self._active = ActiveIdentification(
            run=run, sessions=choice.sessions, left_out=choice.left_out, progress=0.0
        )
        self._task = asyncio.create_task(self._perform(run, choice))
        return run

    def cancel(self, run: str | None = None) -> None:
        """End the running fit, or only this run; there is then no last result.

        Raise RefusedError if none runs, RunOverError.
        """
        require_run(run, None if self._active is None else self._active.run, "fit")
        if self._task is None or self._active is None:
            raise RefusedError("No fit is running.")
        self._task.cancel()

    async def adopt(self, who: str, run: str | None = None) -> list[str]:
        """Adopt the last fit's craft, or only that of this run; return the effects as text.

        Raise RefusedError, RunOverError.
        """
        require_run(run, None if self._last is None else self._last.run, "fit")
        if self._active is not None or self._last is None or self._last.result is None:
            raise RefusedError("There is no fitted craft to adopt. Fit sessions first.")
        return await self._adoption.adopt(self._last.result.craft, who)

    async def close(self) -> None:
        """End the running fit."""
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)

    async def _perform(self, run: str, choice: IdentificationStart) -> None:
        problem, result = CANCELLED, None
        try:
            async with asyncio.timeout(SECONDS_MAX):
                problem, result = await self._fit(choice)
        except TimeoutError:
            problem = f"It was given up after {SECONDS_MAX / 60:.0f} min. Choose fewer sessions."
        except OSError as error:
            problem = f"No process can be started for it ({error.strerror})."
        except Exception as error:
            log.exception("a fit failed")
            problem = explain_internal_error(error)
        finally:
            self._last = EndedIdentification(
                run=run,
                sessions=choice.sessions,
                left_out=choice.left_out,
                problem=problem,
                result=result,
            )
            self._active = None

    async def _fit(self, choice: IdentificationStart) -> tuple[str, IdentificationResult | None]:
        """Problem and result of the process; one of them is empty."""
        database, craft = self._settings.data.database_location, self._settings.craft_file
        with SideProcess(
            "server.features.identification",
            [str(database), str(craft), choice.model_dump_json()],
            # One core at most: control, recording and the page need the others.
            environment={"OPENBLAS_NUM_THREADS": "1"},
        ) as process:
            async for document in process.documents():
                if "progress" in document:
                    assert self._active is not None
                    self._active = self._active.model_copy(update={"progress": document["progress"]})
                elif "result" in document:
                    return "", IdentificationResult.model_validate(document["result"])
                else:
                    return str(document["problem"]), None
            end = await process.describe_end()
            return f"The process of the fit {end} The computer may lack memory.", None
