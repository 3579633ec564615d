"""Charts at normal speed, without reduced motion: drawn at each frame, moving with time, at right heights."""

import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Browser, Page, StorageState

from tests.browser.conftest import bring_to_surface, put_to_rest
from tests.browser.driving import hold_to_arm, wait_for_depth
from tests.browser.opening import DESKTOP
from tests.stack import Stack

SECONDS = 10
"""s that the chart shows."""
WATCHED = 1.5
"""s of motion."""
STEEP = 3.0
"""Rows from one column to the next; at 0.5 m/s a trace falls by less than one."""
LATE = 0.1
"""s by which a drawn trace may be off."""
PROFILE = """(chart) => {
    const canvas = chart.querySelector('.u-over canvas');
    const colour = getComputedStyle(chart.querySelector('.key')).borderTopColor.match(/\\d+/g).map(Number);
    const { data, width, height } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    return Array.from({ length: width }, (_, x) => {
        let sum = 0, weight = 0;
        for (let y = 0; y < height; y++) {
            const at = 4 * (y * width + x);
            if (data[at + 3] < 100) continue;
            if (colour.some((part, index) => Math.abs(part - data[at + index]) > 50)) continue;
            sum += y;
            weight++;
        }
        return weight === 0 ? null : sum / weight;
    });
}"""
"""The row of the first trace in each column of a chart's canvas, found by its colour; null without one."""
HELD = f"""async (chart) => {{
    for (let frame = 0; frame < 2; frame++) await new Promise(requestAnimationFrame);
    return ({PROFILE})(chart);
}}"""
"""The rows once a pause is drawn."""
MOTION = f"""async (chart, seconds) => {{
    const profile = {PROFILE};
    const frame = async () => (await new Promise(requestAnimationFrame), performance.now());
    const context = chart.querySelector('.u-over canvas').getContext('2d');
    let redraws = 0, frames = 0, drawn = 0;
    context.clearRect = function (...area) {{
        redraws++;
        drawn = performance.now();
        CanvasRenderingContext2D.prototype.clearRect.apply(this, area);
    }};
    while (drawn === 0) await frame();
    const began = drawn, before = profile(chart);
    redraws = 0;
    let now = began;
    while (now - began < 1000 * seconds) {{ now = await frame(); frames++; }}
    const after = profile(chart);
    delete context.clearRect;
    return {{ redraws, frames, passed: (drawn - began) / 1000, before, after }};
}}"""
"""The motion of a chart in some seconds: redraws, frames of the browser, and its trace before and after."""

DRAWN, WINDOWS = 20, 3
"""Redraws of the robot, during which other drawings are watched, and how often."""
CHANGES = f"""() => new Promise((done) => {{
    const drawn = ['attitude', 'fins', 'robot'].map((name) => `[data-panel=${{name}}] [role=img] > *`);
    const parts = document.querySelectorAll(drawn);
    const changes = [];
    const watch = new MutationObserver((found) => changes.push(...found.map((one) => one.attributeName)));
    for (const part of parts) watch.observe(part, {{ attributes: true, subtree: true }});
    const context = document.querySelector('[data-panel=robot] canvas').getContext('2d');
    let redraws = 0;
    context.clearRect = function (...area) {{
        CanvasRenderingContext2D.prototype.clearRect.apply(this, area);
        redraws++;
        if (redraws < {DRAWN}) return;
        delete context.clearRect;
        queueMicrotask(() => done({{ parts: parts.length, changes }}));
    }};
}})"""
"""The names of attributes that change in three panels' drawings while the robot is drawn some times."""


@pytest.fixture
def moving(browser: Browser, stack: Stack, cookies: StorageState) -> Iterator[Page]:
    """The page as most people have it, with all its motion."""
    context = browser.new_context(viewport=DESKTOP, storage_state=cookies, reduced_motion="no-preference")
    page = context.new_page()
    bring_to_surface(stack)
    page.goto(stack.url)
    yield page
    context.close()
    put_to_rest(stack)


def test_charts_move_with_the_data_and_show_its_values(moving: Page) -> None:
    panel = moving.get_by_role("region", name="Depth over time")
    panel.get_by_label("Time shown").select_option(f"{SECONDS} s")
    hold_to_arm(moving)
    wait_for_depth(moving, 0.4, 1.0)

    seen = panel.evaluate(MOTION, WATCHED)
    assert seen["redraws"] >= 0.9 * seen["frames"]
    before, after = (np.array(seen[name], dtype=float) for name in ("before", "after"))
    passed = find_shift(before, after) * SECONDS / len(before)
    assert abs(passed - seen["passed"]) < LATE

    panel.get_by_role("button", name="Pause").click()
    check_heights(moving, panel.evaluate(HELD))


def test_instruments_move_without_a_change_of_any_element(moving: Page) -> None:
    """Each change would have the browser lay out the page anew, with every frame."""
    hold_to_arm(moving)
    wait_for_depth(moving, 0.2, 1.0)
    # A message that comes or goes moves the panels once; a drawing would change its elements each time.
    seen = [moving.evaluate(CHANGES) for _ in range(WINDOWS)]
    assert all(frame["parts"] >= 3 for frame in seen)
    assert [] in [frame["changes"] for frame in seen]


def find_shift(before: NDArray[np.float64], after: NDArray[np.float64]) -> int:
    """Return the columns by which the later trace is the earlier one moved to the left."""
    most = len(before) // 2
    errors = [np.nanmean(np.abs(before[shift:] - after[: len(after) - shift])) for shift in range(most)]
    return int(np.argmin(errors))


def check_heights(page: Page, rows: list[Any]) -> None:
    """Under the cursor the trace is as high as the value that is told there, on one scale for all."""
    cursor = page.get_by_role("region", name="Depth over time").get_by_role("slider")
    box = cursor.bounding_box()
    assert box is not None
    heights = np.array(rows, dtype=float)
    # A fall of several rows in a column is no swimming: there the robot was put back to the surface.
    steps = np.abs(np.diff(heights, prepend=heights[0], append=heights[-1]))
    drawn = np.flatnonzero(np.maximum(steps[1:], steps[:-1]) < STEEP).tolist()
    assert len(drawn) > len(rows) / 2
    results = []
    for column in drawn[20 : -20 : len(drawn) // 10]:
        page.mouse.move(box["x"] + column, box["y"] + box["height"] / 2)
        text = cursor.get_attribute("aria-valuetext") or ""
        match = re.search(r"depth (−?[\d.]+)(?: to (−?[\d.]+))? m", text)
        assert match is not None
        depths = [float(group.replace("−", "-")) for group in match.groups() if group is not None]
        results.append((float(np.mean(depths)), heights[column]))
    depths, seen = np.array(results).T
    assert np.ptp(depths) > 0.1
    scale, zero = np.polyfit(depths, seen, 1)
    assert scale > 0, "depth grows downwards"
    assert np.abs(scale * depths + zero - seen).max() < 4
