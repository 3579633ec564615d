"""What it takes to lay three one-hour sessions over each other: over HTTP, and until a page shows them."""

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

from bench.hour import record_hour
from tests.browser.chromium import ARGUMENTS, EXECUTABLE
from tests.stack import ROOT, free_port

SESSIONS = 3
TIMES = 5
READY_SECONDS = 40.0
CONFIG = '[robot]\nname = "bench"\nmode = "robot"\n[link]\nport = "/nowhere"\n'
"""No robot: what is read was recorded before."""


def measure() -> dict[str, float]:
    """ms, each the median of several. `open` begins with a server that has read nothing of the sessions yet,
    `again` and `zoom` (a minute of the hour) come after it, `page` is from the address to the drawn lines.
    """
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder)
        ids = [record_hour(data, seed=seed, name=f"dive {seed}") for seed in range(1, SESSIONS + 1)]
        (data / "robot.toml").write_text(CONFIG)
        opened, again, zoomed, drawn = [], [], [], []
        for _ in range(TIMES):
            with _serve(data) as url:
                wanted = {
                    "sessions": ids,
                    "signals": ["depth.depth", "control.set_point"],
                    "align": {"by": "start"},
                }
                view = {"start": 0.0, "end": 60.0}
                opened.append(_ask(url, "compare", wanted))
                again.append(_ask(url, "compare", wanted | {"align": {"by": "armed"}}))
                zoomed.append(_ask(url, "compare/lines", wanted | {"view": view}))
            with _serve(data) as url:
                drawn.append(_draw(url, ids))
        return {
            "compare.open_ms": statistics.median(opened),
            "compare.again_ms": statistics.median(again),
            "compare.zoom_ms": statistics.median(zoomed),
            "compare.page_ms": statistics.median(drawn),
        }


def _ask(url: str, path: str, wanted: object) -> float:
    began = time.perf_counter()
    httpx.post(f"{url}/api/{path}", json=wanted, timeout=60).raise_for_status()
    return (time.perf_counter() - began) * 1000


def _draw(url: str, ids: list[int]) -> float:
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=EXECUTABLE, args=ARGUMENTS)
        page = browser.new_page(viewport={"width": 1440, "height": 900})
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
def _serve(data: Path) -> Iterator[str]:
    port = free_port()
    command = [str(Path(sys.executable).parent / "mucat"), "run", "--port", str(port), "--data", str(data)]
    command += ["--config", str(data / "robot.toml")]
    with (data / "server.log").open("ab") as log:
        process = subprocess.Popen(command, cwd=ROOT, env=os.environ, stdout=log, stderr=log)
    url = f"http://127.0.0.1:{port}"
    try:
        end = time.monotonic() + READY_SECONDS
        while True:
            try:
                httpx.get(f"{url}/api/health").raise_for_status()
                break
            except httpx.TransportError:
                if process.poll() is not None or time.monotonic() > end:
                    raise
                time.sleep(0.1)
        yield url
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(20)
