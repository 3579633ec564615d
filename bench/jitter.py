"""Jitter of the control loop, alone and while a session is exported and the scene is rendered."""

import tempfile
import time
from contextlib import closing
from itertools import pairwise
from pathlib import Path
from statistics import quantiles

from playwright.sync_api import sync_playwright

from bench.hour import record_hour
from server.features.sessions.recording import Recording
from server.features.sessions.session import find_row
from server.platform.settings import DataFolder
from server.platform.store import Reader
from tests.browser.chromium import ARGUMENTS, EXECUTABLE, sign_in
from tests.stack import Stack

_SECONDS = 100.0
"""Of each part: at 10 Hz a thousand ticks, of which the worst is the p999."""
_SETTLE = 3.0
_ROUNDS = 5
"""More exports than are done in that time; they are made one after the other."""
_PERIOD = 0.1


def measure() -> dict[str, float]:
    """ms by which the time between two ticks differs from their period, p50 and p999, of an armed robot."""
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder)
        hour = record_hour(data)
        with Stack(data) as stack:
            stack.arm()
            idle = _phase()
            with sync_playwright() as playwright:
                browser = playwright.chromium.launch(executable_path=EXECUTABLE, args=ARGUMENTS)
                page = browser.new_page(viewport={"width": 1440, "height": 900})
                sign_in(page.context, stack.url, stack.data)
                page.goto(stack.url)
                page.get_by_role("button", name="bystander").click()
                for kind in ("mcap", "csv", "jsonl") * _ROUNDS:
                    wanted = {"session": hour, "format": kind}
                    stack.api.post("/exports", json=wanted).raise_for_status()
                busy = _phase()
                unfinished = [job for job in stack.api.get("/exports").json() if job["state"] != "done"]
                browser.close()
            if not unfinished:
                raise RuntimeError("the exports were over before the measurement was")
            stack.api.post("/robot/stop").raise_for_status()
            session = stack.api.get("/sessions").json()[0]["id"]
            stack.api.post(f"/sessions/{session}/stop")
        with closing(Reader(DataFolder(data).database)) as store:
            row = find_row(store, session)
            assert row is not None
            times, _ = Recording(store, row).columns("control", [])
    figures = {}
    for name, (start, end) in (("idle", idle), ("busy", busy)):
        ticks = [float(one) for one in times if start <= one <= end]
        errors = [1000 * abs(b - a - _PERIOD) for a, b in pairwise(ticks)]
        figures[f"jitter.control_ms_p50.{name}"] = quantiles(errors, n=1000)[499]
        figures[f"jitter.control_ms_p999.{name}"] = quantiles(errors, n=1000)[998]
    return figures


def _phase() -> tuple[float, float]:
    time.sleep(_SETTLE)
    start = time.monotonic()
    time.sleep(_SECONDS)
    return start, time.monotonic()
