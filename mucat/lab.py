"""A lab's server, or a robot's: sweeps of scenarios in simulated time."""

import csv
import io
import time
from collections.abc import Callable, Sequence
from typing import Any

from mucat.address import RobotAddress
from mucat.errors import RobotError
from mucat.packages import load_package
from mucat.tables import typed_column

POLL_SECONDS = 0.5
DONE = ("complete", "cancelled", "failed", "interrupted")

Progress = Callable[[dict[str, Any]], object]
"""Takes the state of a sweep: `done` of `runs`, `failed`, `remaining` (s) and more."""


class Lab:
    """A server that computes sweeps; `token` is one of `mucat access token`. Methods raise RobotError."""

    def __init__(self, url: str, token: str) -> None:
        self._address = RobotAddress(url, token)

    def sweep(self, text: str, progress: Progress | None = None) -> Any:
        """Run a sweep (TOML) and return its runs as a pandas DataFrame, a row for each, units in its `attrs`.

        `progress` is called with its state now and then. Where this is interrupted, the sweep is cancelled,
        and the same call goes on with what is done.
        """
        number = int(self._address.ask("POST", "/sweeps", {"text": text})["sweep"])
        try:
            self._follow(number, progress)
        except KeyboardInterrupt:
            self._address.ask("POST", f"/sweeps/{number}/cancel")
            raise
        return self.table(number)

    def sweeps(self) -> list[dict[str, Any]]:
        """Return the newest sweeps, newest first."""
        listed: list[dict[str, Any]] = self._address.ask("GET", "/sweeps")
        return listed

    def result(self, sweep: int) -> dict[str, Any]:
        """Return a sweep with its variants, failures by reason and the best variant."""
        detail: dict[str, Any] = self._address.ask("GET", f"/sweeps/{sweep}")
        return detail

    def table(self, sweep: int) -> Any:
        """Return the runs of a sweep that are done as a pandas DataFrame, with the units in its `attrs`."""
        pandas = load_package("pandas")
        text = self._address.fetch("GET", f"/sweeps/{sweep}/table").decode()
        head, *rows = csv.reader(io.StringIO(text))
        columns = zip(*rows, strict=True) if rows else [()] * len(head)
        frame = pandas.DataFrame({name: _column(cells) for name, cells in zip(head, columns, strict=True)})
        detail = self.result(sweep)
        units = {figure["name"]: figure["unit"] for figure in detail["figures"]}
        units |= {parameter["name"]: parameter["unit"] for parameter in detail["parameters"]}
        frame.attrs["units"] = {name: unit for name, unit in units.items() if unit}
        return frame

    def _follow(self, number: int, progress: Progress | None) -> None:
        while True:
            state = next((entry for entry in self.sweeps() if entry["id"] == number), None)
            if state is None:
                raise RobotError("The sweep was deleted meanwhile.")
            if progress is not None:
                progress(state)
            if state["state"] in DONE:
                if state["state"] != "complete":
                    raise RobotError(f"The sweep ended as {state['state']}. {state['problem']}".strip())
                return
            time.sleep(POLL_SECONDS)


def _column(cells: Sequence[str]) -> Sequence[Any]:
    """Return whole numbers, or numbers with NaN for empty cells, or texts."""
    try:
        return [int(cell) for cell in cells]
    except ValueError:
        return typed_column(cells)
