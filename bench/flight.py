"""Redraws of the flight view's instruments, beside a picture that comes as fast as the camera's."""

import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from playwright.sync_api import sync_playwright

from robot_runtime.transport.blocks import Block
from tests.browser.chromium import ARGUMENTS, EXECUTABLE, sign_in
from tests.browser.opening import DESKTOP
from tests.pages.dive_site import DiveSite
from tests.pages.flying import water

_PERIOD = 0.02
"""s between two bundles of samples, as the robot sends them."""
_PICTURE_PERIOD = 1 / 15
_SETTLE = 3.0
_SECONDS = 10.0
# Runs before the page's own code: counts drawings of the instruments; each begins with clearing.
_COUNT = """
(() => {
  globalThis.redraws = 0;
  const clear = CanvasRenderingContext2D.prototype.clearRect;
  CanvasRenderingContext2D.prototype.clearRect = function (...area) {
    if (this.canvas.closest('.instruments')) globalThis.redraws += 1;
    return clear.apply(this, area);
  };
})()
"""


def measure() -> dict[str, float]:
    """Measure redraws of all tapes in a second."""
    with (
        tempfile.TemporaryDirectory() as folder,
        DiveSite(Path(folder), period=_PERIOD, more=_Camera().due) as site,
        sync_playwright() as playwright,
    ):
        browser = playwright.chromium.launch(executable_path=EXECUTABLE, args=ARGUMENTS)
        page = browser.new_page(viewport=DESKTOP)
        sign_in(page.context, site.url, site.data)
        page.add_init_script(_COUNT)
        page.goto(f"{site.url}/#/flight")
        page.locator(".picture img").wait_for()
        page.wait_for_timeout(1000 * _SETTLE)
        before, began = page.evaluate("redraws"), time.monotonic()
        page.wait_for_timeout(1000 * _SECONDS)
        drawn, took = page.evaluate("redraws") - before, time.monotonic() - began
        browser.close()
    return {"fly.redraws_per_s": drawn / took}


class _Camera:
    """A picture each `_PICTURE_PERIOD` s."""

    def __init__(self) -> None:
        self._next = 0.0

    def due(self, now: float) -> Iterator[Block]:
        """Yield the picture that is due."""
        if now < self._next:
            return
        self._next = now + _PICTURE_PERIOD
        yield water(now)


if __name__ == "__main__":
    print(measure())
