"""From the chip to the page: how old a depth is when a real browser has it and draws."""

import tempfile
import time
from pathlib import Path
from statistics import median, quantiles
from typing import Any

from playwright.sync_api import sync_playwright

from robot_runtime.simulation.board import Board
from robot_runtime.topics import BY_NAME
from tests.browser.chromium import ARGUMENTS, EXECUTABLE, sign_in
from tests.stack import Stack

_SECONDS = 20
_ROWS_PER_SECOND = 50

# Runs before the page's own code: notes the board's stamp of each depth, and when it has been drawn.
_WATCH = """
(topic) => {
  globalThis.seen = [];
  const Plain = WebSocket;
  globalThis.WebSocket = class extends Plain {
    constructor(...options) {
      super(...options);
      this.addEventListener('message', ({ data }) => {
        if (!(data instanceof ArrayBuffer)) return;
        const view = new DataView(data);
        for (let at = 0; at < data.byteLength; at += 12 + view.getUint32(at + 8, true)) {
          if (view.getUint8(at) !== topic.id) continue;
          const stamps = [];
          for (let row = 0; row < view.getUint16(at + 2, true); row += 1) {
            stamps.push(view.getUint32(at + 12 + row * topic.bytes + 8, true));
          }
          requestAnimationFrame(() => {
            const drawn = (performance.timeOrigin + performance.now()) / 1000;
            for (const stamp of stamps) globalThis.seen.push([stamp / 1e6, drawn]);
          });
        }
      });
    }
  };
}
"""


def measure() -> dict[str, float]:
    """ms from the moment that the chip stamped a depth until the page has it in a drawn frame."""
    topic = {"id": BY_NAME["depth"].id, "bytes": BY_NAME["depth"].row_bytes}
    with (
        tempfile.TemporaryDirectory() as folder,
        Stack(Path(folder)) as stack,
        sync_playwright() as playwright,
    ):
        browser = playwright.chromium.launch(executable_path=EXECUTABLE, args=ARGUMENTS)
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        sign_in(page.context, stack.url, stack.data)
        page.add_init_script(f"({_WATCH})({topic!r})")
        page.goto(stack.url)
        page.wait_for_function("() => globalThis.seen.length > 100")
        with Board(Path(folder) / "run/board.sock") as board:
            page.evaluate("() => { globalThis.seen.length = 0; }")
            before = _started(board)
            wanted = _ROWS_PER_SECOND * _SECONDS
            page.wait_for_function(f"() => globalThis.seen.length > {wanted}", timeout=2000 * _SECONDS)
            seen: list[list[Any]] = page.evaluate("() => globalThis.seen")
            after = _started(board)
        browser.close()
    # The board's clock falls back where the computer is too slow for it; half of that is the best guess.
    started = (before + after) / 2
    ages = [(drawn - started - stamp) * 1000 for stamp, drawn in seen]
    return {
        "latency.uart_to_page_ms_p50": median(ages),
        "latency.uart_to_page_ms_p95": quantiles(ages, n=20)[-1],
        "latency.board_fell_back_ms": (after - before) * 1000,
    }


def _started(board: Board) -> float:
    """When, in s since 1970, the board's clock stood at zero; it is at most a millisecond behind."""
    return min(time.time() - board.stats()["time"] for _ in range(50))
