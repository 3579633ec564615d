"""Jitter of the control loop: the reading of its times, and the load of the computer meanwhile."""

from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from itertools import pairwise
from pathlib import Path
from statistics import quantiles

from playwright.sync_api import sync_playwright

from server.library.content import Recording
from server.platform.settings import DataFolder
from server.platform.store import Reader
from server.recording.session import find_row
from tests.browser.chromium import ARGUMENTS, EXECUTABLE, sign_in
from tests.stack import Stack

_ROUNDS = 5
"""More exports than are done in that time; they are made one after the other."""
_PERIOD = 0.1


@contextmanager
def busy(stack: Stack, hour: int) -> Iterator[None]:
    """Export the session `hour` and render the scene. Raise RuntimeError where that ends too soon."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=EXECUTABLE, args=ARGUMENTS)
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        sign_in(page.context, stack.url, stack.data)
        page.goto(stack.url)
        page.get_by_role("button", name="bystander").click()
        for kind in ("mcap", "csv", "csv-grid") * _ROUNDS:
            request = {"session": hour, "format": kind}
            stack.api.post("/exports", json=request).raise_for_status()
        yield
        unfinished = [job for job in stack.api.get("/exports").json() if job["state"] != "done"]
        browser.close()
    if not unfinished:
        raise RuntimeError("the exports were over before the measurement was")


def figures(data: Path, session: int, phases: Mapping[str, tuple[float, float]]) -> dict[str, float]:
    """Return the ms by which the time between ticks differs from its period, p50 and p999 of each phase."""
    with closing(Reader(DataFolder(data).database)) as store:
        row = find_row(store, session)
        assert row is not None
        times, _ = Recording(store, row).columns("control", [])
    figures = {}
    for name, (start, end) in phases.items():
        ticks = [float(moment) for moment in times if start <= moment <= end]
        errors = [1000 * abs(b - a - _PERIOD) for a, b in pairwise(ticks)]
        figures[f"jitter.control_ms_p50.{name}"] = quantiles(errors, n=1000)[499]
        figures[f"jitter.control_ms_p999.{name}"] = quantiles(errors, n=1000)[998]
    return figures
