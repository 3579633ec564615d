"""Fixed pieces of work, timed beside the figures: how slow this machine is now, beside a reference machine.

The same computer draws half as fast on one day as on another, and the next computer is another altogether.
Goals in seconds are scaled by these factors; see `bench.goals`.
"""

import json
import math
import struct
import time
from collections.abc import Callable
from typing import Literal, get_args

import numpy as np
from playwright.sync_api import sync_playwright

from tests.browser.chromium import ARGUMENTS, EXECUTABLE

Work = Literal["python", "memory", "drawing"]
Slowness = dict[Work, float]
"""Time that each work takes here, divided by its time on the reference machine; 1 is as fast."""

REFERENCE: dict[Work, float] = {"python": 0.018, "memory": 0.0115, "drawing": 0.065}
"""s of each work on the reference machine: two cores of an AMD EPYC, quiet, with Python 3.11 and Chromium."""
_TIMES = 7
_NUMBERS = 3000
_ARRAY = 2_000_000
_LINES, _POINTS = 48, 1400

_DRAWING = """
([lines, points]) => {
  const canvas = document.querySelector('canvas');
  const context = canvas.getContext('2d');
  const began = performance.now();
  context.clearRect(0, 0, canvas.width, canvas.height);
  for (let line = 0; line < lines; line += 1) {
    context.beginPath();
    for (let x = 0; x < points; x += 1) {
      const y = canvas.height * (0.5 + 0.4 * Math.sin(0.05 * x * (line + 1)));
      context.lineTo(x, y);
      context.lineTo(x, y + 3);
    }
    context.stroke();
  }
  context.getImageData(0, 0, 1, 1);
  return (performance.now() - began) / 1000;
}
"""


def measure_slowness(draws: bool) -> Slowness:
    """Time Python and memory, and drawing too where `draws` is True, which starts a browser."""
    slowness: Slowness = {"python": _best(_interpret), "memory": _best(_copy)}
    if draws:
        slowness["drawing"] = _draw()
    return {work: took / REFERENCE[work] for work, took in slowness.items()}


def mean(before: Slowness, after: Slowness) -> Slowness:
    """Return the geometric mean of two measurements."""
    return {work: math.sqrt(before[work] * after[work]) for work in get_args(Work) if work in before}


def _best(work: Callable[[], object]) -> float:
    took = []
    for _ in range(_TIMES):
        began = time.perf_counter()
        work()
        took.append(time.perf_counter() - began)
    return min(took)


def _interpret() -> None:
    """Pack, parse and look up, as the runtime and the server do."""
    layout = struct.Struct("<d4h")
    table: dict[str, float] = {}
    for number in range(_NUMBERS):
        stamp, *values = layout.unpack(layout.pack(0.01 * number, *((number + k) & 0x7FF for k in range(4))))
        text = json.dumps({"time": stamp, "values": values})
        table[f"{number % 97}"] = sum(json.loads(text)["values"]) + table.get(f"{number % 89}", 0.0) % 7


def _copy() -> None:
    """Pass over arrays that fit into no cache."""
    values = np.arange(_ARRAY, dtype=np.float64)
    for _ in range(3):
        values = values * 1.0001 + values[::-1]


def _draw() -> float:
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=EXECUTABLE, args=ARGUMENTS)
        page = browser.new_page()
        page.set_content('<canvas width="1400" height="800"></canvas>')
        took = min(float(page.evaluate(_DRAWING, [_LINES, _POINTS])) for _ in range(_TIMES))
        browser.close()
    return took
