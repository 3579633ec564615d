"""Time of a seek in a replay of one hour."""

import random
import tempfile
import time
from pathlib import Path
from statistics import quantiles

import httpx
from playwright.sync_api import Page, sync_playwright

from bench.hour import SECONDS, copy_hours
from tests.browser.chromium import ARGUMENTS, EXECUTABLE, sign_in
from tests.browser.replaying import press_depth_slider
from tests.stack import Stack

_SEEKS = 200
_PAGE_SEEKS = 50
_AHEAD = 5.0
_HISTORY = 300.0
"""s after and before the moment, as the page asks for them."""
_PATIENCE_MS = 10_000
_DRAG = f"""(slider, [share, line]) => new Promise((resolve, reject) => {{
    const log = document.querySelector('[role="log"]');
    const {{ left, width }} = slider.getBoundingClientRect();
    const began = performance.now();
    const look = () => {{
        const took = performance.now() - began;
        if (log.textContent.trim().endsWith(line)) resolve(took);
        else if (took > {_PATIENCE_MS}) reject(new Error(`“${{line}}” is not the last line`));
        else requestAnimationFrame(look);
    }};
    slider.dispatchEvent(new PointerEvent('pointermove', {{ bubbles: true, clientX: left + share * width }}));
    look();
}})"""
"""Drags the pressed slider to this share of the dive; returns the ms until the console ends with the line."""


def measure() -> dict[str, float]:
    """Return ms from a seek to a random moment until all of its answer is there, by HTTP; and until the page
    shows the depth of that moment, with the whole robot running beside."""
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder)
        (session,) = copy_hours(data)
        with Stack(data) as stack:
            by_http = _seek(stack.api, session)
            with sync_playwright() as playwright:
                browser = playwright.chromium.launch(executable_path=EXECUTABLE, args=ARGUMENTS)
                page = browser.new_page(viewport={"width": 1440, "height": 900})
                sign_in(page.context, stack.url, stack.data)
                page.goto(f"{stack.url}/#/replay/{session}/60")
                in_page = _seek_in(page)
                browser.close()
    return {
        "replay.seek_ms_p50": quantiles(by_http, n=100)[49],
        "replay.seek_ms_p95": quantiles(by_http, n=100)[94],
        "replay.page_seek_ms_p50": quantiles(in_page, n=100)[49],
        "replay.page_seek_ms_p95": quantiles(in_page, n=100)[94],
    }


def _seek(api: httpx.Client, session: int) -> list[float]:
    chance = random.Random(1)
    delays = []
    for _ in range(_SEEKS):
        start = chance.uniform(0.0, SECONDS)
        query = {"start": start, "end": start + _AHEAD, "history": _HISTORY}
        began = time.perf_counter()
        answer = api.get(f"/sessions/{session}/blocks", params=query)
        delays.append((time.perf_counter() - began) * 1000)
        answer.raise_for_status()
    return delays


def _seek_in(page: Page) -> list[float]:
    """Return the ms of a seek; the dive's console has a line every five seconds, which shows the moment.

    Raise Error of Playwright where the page does not show it.
    """
    chance = random.Random(2)
    slider = press_depth_slider(page)
    delays: list[float] = []
    for _ in range(_PAGE_SEEKS):
        number = chance.randrange(20, 700)
        share = (5 * number + 3) / SECONDS
        delays.append(slider.evaluate(_DRAG, [share, f"pass {5 * number + 0.5:.0f}: all well"]))
    page.mouse.up()
    return delays
