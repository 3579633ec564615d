"""Latency between chip and browser: age of a depth when it is drawn, and time from a key to a fin."""

import random
import tempfile
import time
from pathlib import Path
from statistics import median, quantiles

from playwright.sync_api import Page, expect, sync_playwright

from robot_runtime.contract.packets import Depth
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.simulation.boards.emulator_process import EmulatorClient
from tests.board.host import EmulatedRobot, start
from tests.browser.chromium import ARGUMENTS, EXECUTABLE, sign_in
from tests.stack import Stack

_SECONDS = 10
_ROWS_PER_SECOND = 50
_PRESSES = 60
_KEYS = ("w", "s", "r", "f", "a", "d")
_CHART = "Depth and set point"
_LINE_SECONDS, _LINE_STEP = 0.8, 0.0002
"""s of emulated time; it disarms after a second without a HEARTBEAT."""
_REST = 0.1
"""s without any drive, before a key is pressed."""
_LATE = 5.0
"""s after which a key has moved nothing."""

# Runs before the page's own code. Of the depths that came with the socket's messages it notes the stamps with
# the moment when the chart that holds them was drawn (it is cleared first), and the newest stamp
# with the moment when other digits of the depth were drawn. What a frame draws is seen at that frame's end.
_WATCH = """
(topic) => {
  globalThis.charted = [];
  globalThis.printed = [];
  let undrawn = [];
  let newest = 0;
  const frameEnd = (act) => {
    const { port1, port2 } = new MessageChannel();
    port1.onmessage = () => act((performance.timeOrigin + performance.now()) / 1000);
    port2.postMessage(null);
  };
  const Plain = WebSocket;
  globalThis.WebSocket = class extends Plain {
    constructor(...options) {
      super(...options);
      this.addEventListener('message', ({ data }) => {
        if (!(data instanceof ArrayBuffer)) return;
        const view = new DataView(data);
        for (let at = 0; at < data.byteLength; at += 12 + view.getUint32(at + 8, true)) {
          if (view.getUint8(at) !== topic.id) continue;
          for (let row = 0; row < view.getUint16(at + 2, true); row += 1) {
            newest = view.getUint32(at + 12 + row * topic.bytes + 8, true) / 1e6;
            undrawn.push(newest);
          }
        }
      });
    }
  };
  const clear = CanvasRenderingContext2D.prototype.clearRect;
  CanvasRenderingContext2D.prototype.clearRect = function (...area) {
    const chart = this.canvas.closest('.chart');
    if (this.canvas.closest('.u-over') && chart?.querySelector(`[aria-label*="${topic.chart}"]`)) {
      const stamps = undrawn;
      undrawn = [];
      frameEnd((drawn) => stamps.forEach((stamp) => globalThis.charted.push([stamp, drawn])));
    }
    return clear.apply(this, area);
  };
  addEventListener('DOMContentLoaded', () => {
    new MutationObserver((changes) => {
      if (!changes.some(({ target }) => target.parentElement?.closest('.reading.huge .value'))) return;
      const stamp = newest;
      frameEnd((drawn) => globalThis.printed.push([stamp, drawn]));
    }).observe(document.body, { subtree: true, characterData: true });
  });
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
    """Return the ms from the chip's stamp of a depth until the chart with it is drawn (`sample_to_page`), and
    until the digits that show it are (`sample_to_digits`, which change eight times a second at most); the
    first without the median time that the sample takes to leave the chip's UART (`uart_to_page`), which is
    measured in emulated time; and from a key to the H-bridges' commands.
    """
    topic = {"id": BY_NAME["depth"].id, "bytes": BY_NAME["depth"].row_bytes, "chart": _CHART}
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
        page.wait_for_function("() => globalThis.charted.length > 100 && globalThis.printed.length > 2")
        with EmulatorClient(Path(folder) / "run/board.sock") as board:
            page.evaluate("() => { globalThis.charted.length = 0; globalThis.printed.length = 0; }")
            before = _started(board)
            count = _ROWS_PER_SECOND * _SECONDS
            page.wait_for_function(f"() => globalThis.charted.length > {count}", timeout=2000 * _SECONDS)
            charted, printed = page.evaluate("() => [globalThis.charted, globalThis.printed]")
            after = _started(board)
            keys = _press_keys(page, board)
        browser.close()
    # The board's clock falls back where the computer is too slow for it; half of that is the best guess.
    started = (before + after) / 2
    ages = _ages(charted, started)
    on_line = _line_ms()
    return {
        **_percentiles("latency.sample_to_page_ms", ages),
        **_percentiles("latency.uart_to_page_ms", [age - on_line for age in ages]),
        **_percentiles("latency.sample_to_digits_ms", _ages(printed, started)),
        "latency.sample_to_uart_ms": on_line,
        "latency.board_fell_back_ms": (after - before) * 1000,
        **_percentiles("latency.key_to_fin_ms", keys),
    }


def _ages(drawn: list[list[float]], started: float) -> list[float]:
    """Return the ms from each stamp (s of the board's clock) until it was drawn (s since 1970)."""
    return [(when - started - stamp) * 1000 for stamp, when in drawn]


def _percentiles(name: str, values: list[float]) -> dict[str, float]:
    return {f"{name}_p50": median(values), f"{name}_p95": quantiles(values, n=20)[-1]}


def _line_ms() -> float:
    """Return the median ms from a depth's stamp until its frame has left the UART of a swimming robot."""
    delays = []
    with tempfile.TemporaryDirectory() as folder, start("robot", Path(folder)) as rig:
        robot = EmulatedRobot(rig)
        robot.listen(0.3)
        robot.arm()
        for _ in range(round(_LINE_SECONDS / _LINE_STEP)):
            heard = robot.listen(_LINE_STEP)
            now = rig.board.stats()["time"]
            delays += [(now - packet.time / 1e6) * 1000 for packet in heard if isinstance(packet, Depth)]
    return median(delays)


def _press_keys(page: Page, board: EmulatorClient) -> list[float]:
    """Return the ms from each press, at a random moment of both loops' ticks, to a fin's drive."""
    chance = random.Random(1)
    page.get_by_role("button", name="Manual", exact=True).click()
    arming = page.get_by_role("button", name="Hold to arm")
    arming.hover()
    page.mouse.down()
    expect(arming).to_have_count(0, timeout=10_000)
    page.mouse.up()
    expect(page.get_by_role("group", name="Keys").first).to_be_visible()
    page.evaluate(_KEYS_DOWN)
    delays = []
    for press in range(_PRESSES):
        _wait_for_rest(board)
        time.sleep(chance.uniform(0.0, 0.1))
        key = _KEYS[press % len(_KEYS)]
        page.keyboard.down(key)
        moved = _wait_for_drive(board)
        page.keyboard.up(key)
        delays.append((moved - page.evaluate("() => globalThis.keys.at(-1)")) * 1000)
    page.keyboard.press("Escape")
    return delays


def _wait_for_rest(board: EmulatorClient) -> None:
    rested = time.monotonic()
    while time.monotonic() < rested + _REST:
        if any(board.fins().drives):
            rested = time.monotonic()
        time.sleep(0.002)


def _wait_for_drive(board: EmulatorClient) -> float:
    """Return the time of the first fin's movement, s since 1970."""
    end = time.monotonic() + _LATE
    while not any(board.fins().drives):
        if time.monotonic() > end:
            raise TimeoutError("a key moved no fin")
        time.sleep(0.0005)
    return time.time()


def _started(board: EmulatorClient) -> float:
    """Return the time at which the board's clock stood at zero, s since 1970; at most a millisecond late."""
    return min(time.time() - board.stats()["time"] for _ in range(50))
