"""Cost of twelve live traces at 100 Hz, compared with bare uPlot; and the first view."""

import re
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from playwright.sync_api import Browser, CDPSession, Page, sync_playwright

from bench.hub import open_viewer, process, wait_for_samples
from server.platform.settings import DataFolder
from tests.browser.chromium import ARGUMENTS, EXECUTABLE, sign_in
from tests.stack import free_port

_SIZE = {"width": 1440, "height": 900}
_SETTLE = 5.0
_SECONDS = 10.0
_BUILT = Path("build/bench_page")
_PAGE = Path("server/page")
_DRAWN = """() => [...document.querySelectorAll('canvas')].some((canvas) => {
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    return data.some((value, at) => at % 4 === 3 && value > 0);
})"""
# Runs before the page's own code: counts how often each canvas is drawn anew, which begins with clearing it.
_COUNT = """
(() => {
  const drawn = new Map();
  const clear = CanvasRenderingContext2D.prototype.clearRect;
  CanvasRenderingContext2D.prototype.clearRect = function (...area) {
    drawn.set(this.canvas, (drawn.get(this.canvas) ?? 0) + 1);
    return clear.apply(this, area);
  };
  globalThis.redraws = () => {
    const charts = [...drawn].filter(([canvas]) => canvas.isConnected);
    const over = charts.filter(([canvas]) => canvas.closest('.u-over'));
    const counts = (over.length ? over : charts).map(([, count]) => count);
    drawn.clear();
    return counts.reduce((sum, count) => sum + count, 0) / counts.length;
  };
})()
"""
_WINDOWS = {"": "", ".10s": "?seconds=10"}
"""Time that the charts span: a minute, and 10 s, in which the traces move six times as fast."""


def measure() -> dict[str, float]:
    """Measure four charts of three traces: redraws of all of them in a second, ms of the main thread's
    own processor time for each redraw, all else included; kB of the first view, compressed.
    """
    figures: dict[str, float] = {}
    with serve_charts(_BUILT) as (url, data, browser):
        for name, path in (("page", ""), ("uplot", "bare.html")):
            for window, query in _WINDOWS.items():
                page, devtools = open_charts(browser, url, data, f"{url}/{path}{query}")
                drawn = _draw(page, devtools)
                figures |= {f"{name}.{figure}{window}": value for figure, value in drawn.items()}
                page.context.close()
    return figures | _first_view()


@contextmanager
def serve_charts(built: Path) -> Iterator[tuple[str, Path, Browser]]:
    """Serve the charts, built into this folder, with samples; yield address, data folder and browser."""
    build = ["npx", "vite", "build", "--config", "bench/vite.config.ts", "--logLevel", "error"]
    build += ["--outDir", str(built.absolute())]
    subprocess.run(build, cwd="frontend", check=True)
    with tempfile.TemporaryDirectory() as folder:
        data, port = Path(folder), free_port()
        url = f"http://127.0.0.1:{port}"
        DataFolder(data).run.mkdir()
        with (
            process("server", folder, str(port), str(built)),
            process("source", folder),
            sync_playwright() as playwright,
        ):
            wait_for_samples(lambda: open_viewer(data, port))
            browser = playwright.chromium.launch(executable_path=EXECUTABLE, args=ARGUMENTS)
            yield url, data, browser
            browser.close()


def _first_view() -> dict[str, float]:
    """Return kB, compressed, of the first view: the page, the files that it links, and its font."""
    index = (_PAGE / "index.html").read_text()
    code = [_PAGE / name for name in re.findall(r"(?:src|href)=\"/(assets/[^\"]+)\"", index)]
    bundle = sum(map(_sent, [_PAGE / "index.html", *code]))
    fonts = sum(map(_sent, _PAGE.glob("assets/inter-latin-wght-*.woff2")))
    return {"page.bundle_kb_gz": bundle / 1000, "page.first_view_kb": (bundle + fonts) / 1000}


def _sent(file: Path) -> int:
    packed = file.with_name(f"{file.name}.gz")
    return (packed if packed.exists() else file).stat().st_size


def open_charts(browser: Browser, url: str, data: Path, address: str) -> tuple[Page, CDPSession]:
    """Return a page with drawn charts, and the developer's tools of it."""
    page = browser.new_page(viewport=_SIZE)  # type: ignore[arg-type]
    sign_in(page.context, url, data)
    page.add_init_script(_COUNT)
    page.goto(address)
    page.wait_for_function(_DRAWN)
    return page, page.context.new_cdp_session(page)


def _draw(page: Page, devtools: CDPSession) -> dict[str, float]:
    devtools.send("Performance.enable", {"timeDomain": "threadTicks"})
    page.wait_for_timeout(1000 * _SETTLE)
    page.evaluate("() => globalThis.redraws()")
    began, busy = time.monotonic(), _busy(devtools)
    page.wait_for_timeout(1000 * _SECONDS)
    redraws = page.evaluate("() => globalThis.redraws()")
    took, busy = time.monotonic() - began, _busy(devtools) - busy
    return {"redraws_per_s": redraws / took, "redraw_ms": busy / redraws * 1000}


def _busy(devtools: CDPSession) -> float:
    metrics = {
        metric["name"]: metric["value"] for metric in devtools.send("Performance.getMetrics")["metrics"]
    }
    return float(metrics["TaskDuration"])
