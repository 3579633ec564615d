"""Charts: history after a reload, pause, zoom, the cursor by mouse, keys and touch."""

import re

from playwright.sync_api import Locator, Page, expect

DRAWN = """(chart) => [...chart.querySelectorAll('canvas')].some((canvas) => {
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    return data.some((value, at) => at % 4 === 3 && value > 0);
})"""
"""Whether anything stands on the chart's own canvases."""


def depth_chart(page: Page) -> tuple[Locator, Locator]:
    """Return the panel, and the element in it that takes pointers and keys."""
    page.get_by_role("link", name="Operate").click()
    panel = page.get_by_role("region", name="Depth over time")
    panel.scroll_into_view_if_needed()
    return panel, panel.get_by_role("slider")


def drag(page: Page, cursor: Locator, start: float, end: float) -> None:
    """Drag the mouse between these shares of the chart's width."""
    box = cursor.bounding_box()
    assert box is not None
    y = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + start * box["width"], y)
    page.mouse.down()
    page.mouse.move(box["x"] + (start + end) / 2 * box["width"], y)
    page.mouse.move(box["x"] + end * box["width"], y)
    page.mouse.up()


def pinch(page: Page, cursor: Locator) -> None:
    """Move two fingers apart."""
    box = cursor.bounding_box()
    assert box is not None
    devtools = page.context.new_cdp_session(page)
    middle, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    for kind, apart in (("touchStart", 20), ("touchMove", 40), ("touchMove", 80), ("touchEnd", None)):
        points = [] if apart is None else [{"x": middle + side * apart, "y": y} for side in (-1, 1)]
        devtools.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})


def test_charts_show_their_history_after_a_reload(page: Page) -> None:
    panel, cursor = depth_chart(page)
    expect(cursor).to_have_attribute("aria-valuetext", re.compile(r"now: depth \S+ m, set point"))
    page.wait_for_function("() => performance.now() > 4000")
    with page.expect_response("**/api/past?*") as asked:
        page.reload()
        panel.get_by_label("Time shown").select_option("10 min")
    assert asked.value.ok
    panel.get_by_label("Time shown").select_option("10 s")
    # Three seconds ago this page was not there yet.
    cursor.press("ArrowLeft")
    for _ in range(59):
        cursor.press("ArrowLeft")
    assert page.evaluate("() => performance.now()") < 60_000
    expect(cursor).to_have_attribute("aria-valuetext", re.compile(r"^3\.0 s ago: depth −?\d"))
    assert panel.evaluate(DRAWN)


def test_pause_zoom_and_cursor(any_page: Page) -> None:
    page = any_page
    panel, cursor = depth_chart(page)
    expect(cursor).to_have_attribute("aria-valuetext", re.compile(r"now: depth −?\d"))
    panel.get_by_role("button", name="Pause").click()
    expect(panel.get_by_text("Paused")).to_be_visible()
    cursor.press("Home")
    held = cursor.get_attribute("aria-valuetext")
    assert held is not None
    assert re.match(r"at \d\d:\d\d:\d\d\.\d: depth", held)
    drag(page, cursor, 0.5, 0.75)
    expect(panel.get_by_text("Zoomed")).to_be_visible()
    expect(cursor).to_have_attribute("aria-valuemin", re.compile(r"^-1[45]"))
    cursor.press("+")
    expect(cursor).to_have_attribute("aria-valuemin", re.compile(r"^-1[01]"))
    assert panel.evaluate(DRAWN)
    cursor.dblclick()
    expect(panel.get_by_text("Zoomed")).to_be_hidden()
    expect(cursor).to_have_attribute("aria-valuemin", "-60")
    pinch(page, cursor)
    expect(panel.get_by_text("Zoomed")).to_be_visible()
    panel.get_by_role("button", name="Resume").click()
    expect(cursor).to_have_attribute("aria-valuemin", "-60")
