"""Time to compare three one-hour sessions: over HTTP, and until a page shows them."""

import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
from playwright.sync_api import sync_playwright

from bench.hour import copy_hours
from server.platform.settings import DataFolder
from tests.browser.chromium import ARGUMENTS, EXECUTABLE, sign_in
from tests.shell import ShellAuth
from tests.stack import ROOT, free_port

SESSIONS = 3
TIMES = 5
READY_SECONDS = 40.0
CONFIG = '[robot]\nname = "bench"\nmode = "robot"\n[link]\nport = "/nowhere"\n'
"""No robot: what is read was recorded before."""


def measure() -> dict[str, float]:
    """Return ms, each the median of several. `open` begins with a server that has read nothing of the
    sessions yet, `again` and `zoom` (a minute of the hour) come after it; `page_open` is from address to
    drawn lines.
    """
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder)
        ids = copy_hours(data, SESSIONS)
        (data / "robot.toml").write_text(CONFIG)
        opened, again, zoomed, drawn = [], [], [], []
        for _ in range(TIMES):
            with serve_recordings(data) as api:
                request = {
                    "sessions": ids,
                    "signals": ["depth.depth", "control.set_point"],
                    "align": {"by": "start"},
                }
                view = {"start": 0.0, "end": 60.0}
                opened.append(_ask(api, "compare", request))
                again.append(_ask(api, "compare", request | {"align": {"by": "armed"}}))
                zoomed.append(_ask(api, "compare/lines", request | {"view": view}))
            with serve_recordings(data) as api:
                drawn.append(_draw(api, data, ids))
        return {
            "compare.open_ms": statistics.median(opened),
            "compare.again_ms": statistics.median(again),
            "compare.zoom_ms": statistics.median(zoomed),
            "compare.page_open_ms": statistics.median(drawn),
        }


def _ask(api: httpx.Client, path: str, request: object) -> float:
    began = time.perf_counter()
    api.post(f"/api/{path}", json=request).raise_for_status()
    return (time.perf_counter() - began) * 1000


def _draw(api: httpx.Client, data: Path, ids: list[int]) -> float:
    url = str(api.base_url).rstrip("/")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=EXECUTABLE, args=ARGUMENTS)
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        sign_in(page.context, url, data)
        began = time.perf_counter()
        page.goto(f"{url}/#/sessions/compare/{','.join(map(str, ids))}")
        page.wait_for_function(
            "(lines) => document.querySelectorAll('.scatterlayer path.js-line').length === lines",
            arg=2 * len(ids),
        )
        took = (time.perf_counter() - began) * 1000
        browser.close()
    return took


@contextmanager
def serve_recordings(data: Path) -> Iterator[httpx.Client]:
    port = free_port()
    command = [str(Path(sys.executable).parent / "mucat"), "run", "--port", str(port), "--data", str(data)]
    command += ["--config", str(data / "robot.toml")]
    with (data / "server.log").open("ab") as log:
        process = subprocess.Popen(command, cwd=ROOT, env=os.environ, stdout=log, stderr=log)
    api = httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=60, auth=ShellAuth(DataFolder(data)))
    try:
        end = time.monotonic() + READY_SECONDS
        while True:
            try:
                api.get("/api/health").raise_for_status()
                break
            except httpx.HTTPError:  # also 401: its token is not there before it is
                if process.poll() is not None or time.monotonic() > end:
                    raise
                time.sleep(0.1)
        yield api
    finally:
        api.close()
        process.send_signal(signal.SIGINT)
        process.wait(20)
