"""Replays whose recording needs no robot that dives."""

import re

from playwright.sync_api import Page, expect

from tests.browser.replaying import press_depth_slider
from tests.browser.site import Site
from tests.waiting import wait_for

DRAG = """async (slider) => {
    let written = 0;
    const began = performance.now();
    const replace = history.replaceState.bind(history);
    history.replaceState = (...all) => {
        written += 1;
        replace(...all);
    };
    const { left, width } = slider.getBoundingClientRect();
    for (let move = 1; move <= 100; move += 1) {
        const clientX = left + (width / 2) * (move / 100);
        slider.dispatchEvent(new PointerEvent('pointermove', { bubbles: true, clientX }));
        // The page's effects run between two moves.
        await Promise.resolve();
        await Promise.resolve();
    }
    return [written, performance.now() - began];
}"""
"""Drags the pressed slider to its middle; returns how often the page wrote its address, and the ms of it."""
WRITE_AFTER = 300.0
"""ms from one writing of the address to the next one at least."""


def test_a_drag_of_the_slider_seldom_writes_the_address(page: Page, site: Site) -> None:
    session = site.api.post("/sessions", json={"name": "short"}).raise_for_status().json()["id"]
    address = f"/sessions/{session}"
    wait_for(lambda: site.api.get(address).json()["duration"] > 2, "two seconds of the recording")
    site.api.post(f"{address}/stop").raise_for_status()
    page.goto(f"{site.url}/#/replay/{session}")
    slider = press_depth_slider(page)
    written, took = slider.evaluate(DRAG)
    # The press has written it, perhaps longer ago.
    assert written <= 1 + took / WRITE_AFTER + 1
    expect(page).to_have_url(re.compile(rf"#/replay/{session}\?.*\bat=1(\.\d)?(&|$)"))
    page.mouse.up()
