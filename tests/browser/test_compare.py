"""Two recorded sessions overlaid; their report, opened without any network."""

import re
from pathlib import Path

from playwright.sync_api import Browser, Page, Route, expect

from tests.browser.driving import hold_to_arm
from tests.browser.pages import samples
from tests.stack import Stack
from tests.waiting import wait_for

LINES = ".scatterlayer .trace path.js-line"
DRAWN = 500
"""Samples, of about 300 a second."""


def record(page: Page, stack: Stack, name: str, *, armed: bool) -> int:
    """Record a short session through the interface. Return its number."""
    session = stack.api.post("/sessions", json={"name": name}).raise_for_status().json()
    page.goto(f"{stack.url}/#/operate")
    if armed:
        hold_to_arm(page)
    before = samples(stack, session["id"])
    wait_for(lambda: samples(stack, session["id"]) > before + DRAWN, "something to be drawn after the arming")
    stack.api.post("/robot/stop").raise_for_status()
    stack.api.post(f"/sessions/{session['id']}/stop").raise_for_status()
    return int(session["id"])


def test_two_sessions_are_overlaid(page: Page, browser: Browser, stack: Stack, tmp_path: Path) -> None:
    complaints: list[str] = []
    page.on("console", lambda message: complaints.append(message.text) if message.type == "error" else None)
    first = record(page, stack, "with fins", armed=True)
    other = record(page, stack, "without", armed=False)
    order: list[str] = []
    page.on("request", lambda request: order.append(f"ask {request.url}"))
    page.on("response", lambda response: order.append(f"got {response.url}"))
    held = hold_figures(page)
    page.goto(f"{stack.url}/#/sessions/compare/{first},{other}")
    expect(page.get_by_role("link", name="with fins", exact=True)).to_be_visible()
    expect(page.locator(LINES)).to_have_count(4)
    expect(page.get_by_text("Figures are being computed…")).to_be_visible()
    while not held:
        page.wait_for_timeout(10)  # the page says so before its question has come here
    with page.expect_request("**/signals"):
        (question,) = held
        question.continue_()
    page.unroute("**/api/compare")
    check_order(order)

    page.get_by_role("button", name="Figures 14 to 16").click()
    expect(page.locator(".ytick").first).to_be_visible()
    expect(page.get_by_text("Heave command")).to_be_visible()
    figures = page.get_by_role("region", name="Figures of the sessions")
    strokes = figures.get_by_role("row", name=re.compile("^Fin strokes"))
    expect(strokes.get_by_role("button").nth(1)).to_have_text(re.compile(r"^\d+$"))
    expect(strokes.get_by_role("button").nth(2)).to_have_text("none")
    strokes.get_by_role("button").nth(2).hover()
    expect(page.get_by_text("The robot was never armed in this session.")).to_be_visible()

    page.set_viewport_size({"width": 1100, "height": 900})
    expect(page.locator(".main-svg").first).to_have_attribute("width", re.compile("^10"))
    expect(page.locator(LINES).first).to_be_visible()

    page.get_by_label("Align at").select_option("armed")
    expect(page.get_by_text("never armed in this session. It is not drawn.")).to_be_visible()
    expect(page.get_by_text("s since arming")).to_be_visible()
    shapes = page.locator(".shapelayer path")
    count = shapes.count()
    figures.get_by_role("row", name=re.compile("^RMSE")).get_by_role("button").nth(1).hover()
    expect(shapes).to_have_count(count + 1)

    page.get_by_label("From", exact=True).fill("0.5")
    page.get_by_label("From", exact=True).press("Enter")
    expect(page.get_by_role("button", name="Whole time")).to_be_enabled()
    page.get_by_role("button", name="Visible range").click()
    expect(page.get_by_role("button", name=re.compile(r"^0\.5 to "))).to_be_visible()

    check_files(page, tmp_path)
    check_report(page, browser, tmp_path / "report.html")
    assert complaints == []


def hold_figures(page: Page) -> list[Route]:
    """Keep questions for figures from the server, since no line waits for them. Return the questions."""
    held: list[Route] = []

    def look(route: Route) -> None:
        expected = route.request.post_data_json or {}
        if expected["figures"]:
            held.append(route)
        else:
            route.continue_()

    page.route("**/api/compare", look)
    return held


def check_order(order: list[str]) -> None:
    """Plotly is fetched while the server compares; the list of signals waits until that is done."""

    def position_of(start: str, part: str) -> int:
        return next(at for at, line in enumerate(order) if line.startswith(start) and part in line)

    assert (
        position_of("ask", "/assets/plotly-basic")
        < position_of("got", "/api/compare")
        < position_of("ask", "/signals")
    )


def check_files(page: Page, folder: Path) -> None:
    """Charts can be saved as pictures."""
    beginnings = {"PNG": b"\x89PNG\r\n", "SVG": b"<svg "}
    for name, beginning in beginnings.items():
        with page.expect_download() as download:
            page.get_by_role("button", name=name, exact=True).click()
        path = folder / name
        download.value.save_as(path)
        assert path.read_bytes().startswith(beginning)


def below_title(page: Page) -> float:
    """Pixels from the page's title to the choice of signals."""
    title, depth = (
        page.get_by_role("heading", level=1).bounding_box(),
        page.get_by_role("button", name="Depth", exact=True).bounding_box(),
    )
    assert title is not None
    assert depth is not None
    return depth["y"] - title["y"]


def check_report(page: Page, browser: Browser, path: Path) -> None:
    """The report opens without any network, requests nothing, and has its charts and tables."""
    before = below_title(page)
    page.get_by_label("Align at").select_option("start")
    expect(page.get_by_text("It is not drawn.")).to_have_count(0)
    assert below_title(page) == before, "the controls moved when the answer came: a click could miss them"
    page.get_by_role("button", name="Depth", exact=True).click()
    # Fewer charts: what stands below them moves up when they come.
    expect(page.get_by_text("Heave command")).to_have_count(0)
    with page.expect_download() as download:
        page.get_by_role("link", name="HTML report").click()
    download.value.save_as(path)
    context = browser.new_context(offline=True)
    report = context.new_page()
    asked: list[str] = []
    complaints: list[str] = []
    report.on("request", lambda request: asked.append(request.url))
    report.on("pageerror", lambda error: complaints.append(str(error)))
    report.goto(path.as_uri())
    expect(report.locator(LINES)).to_have_count(4)
    expect(report.get_by_role("heading", name="with fins, without")).to_be_visible()
    expect(report.get_by_role("row", name=re.compile("^Fin strokes"))).to_be_visible()
    assert [url for url in asked if not url.startswith(("file:", "data:", "blob:"))] == []
    assert complaints == []
    context.close()
