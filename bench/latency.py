"""Latency between chip and browser: age of a depth when it is drawn, and time from a key to a fin."""

import random
import tempfile
import time
from pathlib import Path
from statistics import median, quantiles
from typing import Any

from playwright.sync_api import Page, expect, sync_playwright

from robot_runtime.contract.topics import BY_NAME
from robot_runtime.simulation.boards.emulator_process import EmulatorClient
from tests.browser.chromium import ARGUMENTS, EXECUTABLE, sign_in
from tests.stack import Stack

_SECONDS = 20
_ROWS_PER_SECOND = 50
_PRESSES = 60
_KEYS = ("w", "s", "r", "f", "a", "d")
_REST = 0.1
"""s without any drive, before a key is pressed."""
_LATE = 5.0
"""s after which a key has moved nothing."""

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


# When keys went down, by the computer's clock.
_KEYS_DOWN = """
() => {
  globalThis.keys = [];
  addEventListener('keydown', ({ timeStamp }) => {
    globalThis.keys.push((performance.timeOrigin + timeStamp) / 1000);
  }, true);
}
"""


def measure() -> dict[str, float]:
    """ms from the chip's stamp of a depth to the drawn frame, and from a key to the H-bridges' commands."""
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
        with EmulatorClient(Path(folder) / "run/board.sock") as board:
            page.evaluate("() => { globalThis.seen.length = 0; }")
            before = _started(board)
            wanted = _ROWS_PER_SECOND * _SECONDS
            page.wait_for_function(f"() => globalThis.seen.length > {wanted}", timeout=2000 * _SECONDS)
            seen: list[list[Any]] = page.evaluate("() => globalThis.seen")
            after = _started(board)
            keys = _press_keys(page, board)
        browser.close()
    # The board's clock falls back where the computer is too slow for it; half of that is the best guess.
    started = (before + after) / 2
    ages = [(drawn - started - stamp) * 1000 for stamp, drawn in seen]
    return {
        "latency.sample_to_page_ms_p50": median(ages),
        "latency.sample_to_page_ms_p95": quantiles(ages, n=20)[-1],
        "latency.board_fell_back_ms": (after - before) * 1000,
        "latency.key_to_fin_ms_p50": median(keys),
        "latency.key_to_fin_ms_p95": quantiles(keys, n=20)[-1],
    }


def _press_keys(page: Page, board: EmulatorClient) -> list[float]:
    """ms from each press, at a random moment of the control loop's and the chip's ticks, to a fin's drive."""
    chance = random.Random(1)
    page.get_by_role("button", name="Manual", exact=True).click()
    page.get_by_role("button", name="Hold to arm").hover()
    page.mouse.down()
    expect(page.get_by_role("region", name="Drive")).to_be_visible(timeout=10_000)
    page.mouse.up()
    page.evaluate(_KEYS_DOWN)
    found = []
    for press in range(_PRESSES):
        _wait_for_rest(board)
        time.sleep(chance.uniform(0.0, 0.1))
        key = _KEYS[press % len(_KEYS)]
        page.keyboard.down(key)
        moved = _wait_for_drive(board)
        page.keyboard.up(key)
        found.append((moved - page.evaluate("() => globalThis.keys.at(-1)")) * 1000)
    page.keyboard.press("Escape")
    return found


def _wait_for_rest(board: EmulatorClient) -> None:
    rested = time.monotonic()
    while time.monotonic() < rested + _REST:
        if any(board.fins().drives):
            rested = time.monotonic()
        time.sleep(0.002)


def _wait_for_drive(board: EmulatorClient) -> float:
    """When it was, s since 1970."""
    end = time.monotonic() + _LATE
    while not any(board.fins().drives):
        if time.monotonic() > end:
            raise TimeoutError("a key moved no fin")
        time.sleep(0.0005)
    return time.time()


def _started(board: EmulatorClient) -> float:
    """When, in s since 1970, the board's clock stood at zero; it is at most a millisecond behind."""
    return min(time.time() - board.stats()["time"] for _ in range(50))
