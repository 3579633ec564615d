"""A sweep from a shell: computed here if no server uses the data folder, else by the server."""

import asyncio
import signal
import sys
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from time import sleep
from typing import Any

from server.features.sweeps.config import SweepsConfig
from server.features.sweeps.order import reopen
from server.features.sweeps.runner import SweepRunner
from server.features.sweeps.schemas import SweepSummary
from server.features.sweeps.store import SweepStore
from server.features.sweeps.table import write_table
from server.platform.folder_lock import FolderInUseError, claim
from server.platform.running_server import ask, fetch
from server.platform.settings import DataFolder, Settings, SetupError
from server.platform.shell_store import open_writer
from server.platform.store import Store
from server.platform.terminal import echo

POLL_SECONDS = 0.5
WHO = "shell"
ELSEWHERE = (
    "A server uses this data folder, and computes by its own settings: set [sweeps] in robot.toml, or choose "
    "another folder with --data."
)


def run_sweep(text: str, table: Path | None, settings: Settings, config: SweepsConfig, *, own: bool) -> int:
    """Run a sweep with a line of progress. Return the exit status: 1 where it is not complete.

    With `own`, `config` differs from the settings. Raise ConfigError, SetupError.
    """
    with ExitStack() as claimed:
        try:
            claimed.enter_context(claim(settings.data))
        except FolderInUseError:
            if own:
                raise SetupError(ELSEWHERE) from None
            return _run_there(text, table, settings.data)
        with open_writer(settings.data) as store:
            return asyncio.run(_run_here(text, table, settings, config, store))


async def _run_here(
    text: str, table: Path | None, settings: Settings, config: SweepsConfig, store: Store
) -> int:
    line = _ProgressLine()
    sweeps = SweepStore(store)
    runner = SweepRunner(settings, config, sweeps, line.notify)
    await runner.recover()
    planned = await asyncio.to_thread(runner.read, text)
    number = await runner.start(planned, WHO)
    loop = asyncio.get_running_loop()
    ending: list[asyncio.Task[None]] = []
    for sent in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(sent, lambda: ending.append(asyncio.create_task(runner.cancel(number))))
    await runner.wait()
    await asyncio.gather(*ending, return_exceptions=True)
    row = sweeps.find(number)
    if table is not None:
        _write(table, write_table(reopen(row.text, row.scenario_text), sweeps.runs(number)))
    return line.conclude(runner.describe(row))


def _run_there(text: str, table: Path | None, folder: DataFolder) -> int:
    number = ask(folder, "POST", "/sweeps", {"text": text}, SECONDS_CHECK)["sweep"]
    line = _ProgressLine()
    path = f"/sweeps/{number}"
    try:
        summary = _follow(folder, number, line.show)
    except KeyboardInterrupt:
        ask(folder, "POST", f"{path}/cancel")
        summary = _follow(folder, number, line.show)
    if table is not None:
        _write(table, fetch(folder, f"{path}/table").decode())
    return line.conclude(summary)


SECONDS_CHECK = 60.0
"""For checking a large document."""


def _follow(folder: DataFolder, number: int, show: Callable[[SweepSummary], None]) -> SweepSummary:
    while True:
        listed = [SweepSummary.model_validate(entry) for entry in ask(folder, "GET", "/sweeps")]
        summary = next((entry for entry in listed if entry.id == number), None)
        if summary is None:
            raise SetupError("The sweep was deleted meanwhile.")
        show(summary)
        if summary.state not in ("running", "waiting"):
            return summary
        sleep(POLL_SECONDS)


def _write(path: Path, text: str) -> None:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as problem:
        raise SetupError(f"{path} cannot be written: {problem.strerror}.") from problem


class _ProgressLine:
    """A line that is written anew at a terminal, and now and then elsewhere."""

    def __init__(self) -> None:
        self._shown = ""
        self._terminal = sys.stderr.isatty()

    def notify(self, message: dict[str, Any]) -> None:
        """Show the first sweep of the runner's message."""
        for entry in message["sweeps"][:1]:
            self.show(SweepSummary.model_validate(entry))

    def show(self, summary: SweepSummary) -> None:
        """Show the progress."""
        text = f"{summary.title}: {summary.done} of {summary.runs} runs"
        if summary.failed:
            text += f", {summary.failed} failed"
        if summary.state == "waiting":
            text += ", waiting for others"
        elif summary.remaining is not None and summary.state == "running":
            text += f", {_duration(summary.remaining)} to go"
        if summary.problem:
            text += f". {summary.problem}"
        if self._terminal and text != self._shown:
            self._shown = text
            sys.stderr.write(f"\r\x1b[K{text}")
            sys.stderr.flush()

    def conclude(self, summary: SweepSummary) -> int:
        """Print the end; return the exit status."""
        if self._terminal:
            sys.stderr.write("\r\x1b[K")
        text = f"{summary.title}: {summary.state}. {summary.done} of {summary.runs} runs"
        text += f", {summary.failed} failed." if summary.failed else "."
        if summary.best is not None:
            values = ", ".join(
                f"{name} = {value}"
                for name, value in zip(summary.parameters, summary.best.values, strict=True)
                if value is not None
            )
            text += f" Best: {values or 'the scenario'} with {summary.best_figure} {summary.best.mean:.4g}."
        echo(f"{text} {summary.problem}".strip())
        return 0 if summary.state == "complete" else 1


def _duration(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min {rest} s" if minutes else f"{rest} s"
