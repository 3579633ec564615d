"""Growth of the page's heap while twelve live traces at 100 Hz are drawn."""

import time
from pathlib import Path

import numpy as np
from playwright.sync_api import CDPSession, Page

from bench.page import open_charts, serve_charts

_SETTLE = 40.0
_SECONDS = 900.0
"""Counts scatter by 0.11 MB: over this time the slope is known to 0.2 MB an hour, over 150 s to 3."""
_EVERY = 2.0
_READINGS = 5
"""The lowest of so many counts: a redraw under way holds 250 kB more."""
_BUILT = Path("build/bench_heap")


def measure() -> dict[str, float]:
    """Return the MB by which it would grow in an hour, of four charts of three traces over a minute."""
    with serve_charts(_BUILT) as (url, data, browser):
        page, devtools = open_charts(browser, url, data, f"{url}/")
        page.wait_for_timeout(1000 * _SETTLE)
        return {"page.heap_growth_mb_per_h": _grow(page, devtools)}


def _grow(page: Page, devtools: CDPSession) -> float:
    """Return the slope of the heap's size after the garbage is gone."""
    points: list[tuple[float, float]] = []
    began = time.monotonic()
    while time.monotonic() - began < _SECONDS:
        at = time.monotonic()
        points.append((at, min(_read(page, devtools) for _ in range(_READINGS))))
    times, sizes = zip(*points, strict=True)
    return float(np.polyfit(times, sizes, 1)[0]) * 3600 / 1e6


def _read(page: Page, devtools: CDPSession) -> int:
    """Wait, and return the bytes on the heap after a collection of garbage."""
    page.wait_for_timeout(1000 * _EVERY)
    devtools.send("HeapProfiler.collectGarbage")
    return int(devtools.send("Runtime.getHeapUsage")["usedSize"])
