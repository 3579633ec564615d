"""Time until a session's page shows its dive: of an hour, and of eight."""

import statistics
import tempfile
import time
from pathlib import Path

import httpx
from playwright.sync_api import sync_playwright

from bench.compare import CONFIG, serve_recordings
from bench.hour import copy_hours, record_hour
from tests.browser.chromium import ARGUMENTS, EXECUTABLE, sign_in

TIMES = 3
EIGHT_HOURS = 8 * 3600.0


def measure() -> dict[str, float]:
    """Return ms from the address to the drawn depth, the median of several servers that have read nothing."""
    with tempfile.TemporaryDirectory() as folder:
        hour, eight = Path(folder, "hour"), Path(folder, "eight")
        copy_hours(hour)
        record_hour(eight, EIGHT_HOURS)
        return {"story.hour_ms": _open(hour), "story.eight_hours_ms": _open(eight)}


def _open(data: Path) -> float:
    (data / "robot.toml").write_text(CONFIG)
    opened = []
    for _ in range(TIMES):
        with serve_recordings(data) as api:
            opened.append(_draw(api, data))
    return statistics.median(opened)


def _draw(api: httpx.Client, data: Path) -> float:
    url = str(api.base_url).rstrip("/")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=EXECUTABLE, args=ARGUMENTS)
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        sign_in(page.context, url, data)
        began = time.perf_counter()
        page.goto(f"{url}/#/sessions/1")
        page.wait_for_function("() => document.querySelector('path.depth') !== null")
        took = (time.perf_counter() - began) * 1000
        browser.close()
    return took
