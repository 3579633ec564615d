"""A session's page as one dive: curve, moment, segments, range and track, by pointer, keys and address."""

import re
import time
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, ViewportSize, expect

from server.platform.settings import Settings
from server.platform.store import Store
from tests.browser.opening import DESKTOP, PHONE, opened_page, signed_in
from tests.pages.dive_site import DiveSite, recorded_site
from tests.server.analysis.dives import dive, record


def record_dives(store: Store, settings: Settings) -> None:
    record(store, settings, dive(), name="two steps")
    record(store, settings, dive(arms=False), name="afloat")
    record(store, settings, [], name="nothing")


@pytest.fixture(scope="module")
def dives(tmp_path_factory: pytest.TempPathFactory) -> Iterator[DiveSite]:
    """A server that has a dive of two segments, one that never armed, and an empty session."""
    with recorded_site(tmp_path_factory.mktemp("data"), record_dives) as site:
        yield site


@pytest.fixture
def page(browser: Browser, dives: DiveSite) -> Iterator[Page]:
    with opened_page(browser, dives, signed_in(browser, dives), DESKTOP) as page:
        yield page


def test_a_dive_is_looked_at_segment_by_segment(page: Page, dives: DiveSite) -> None:
    page.goto(f"{dives.url}/#/sessions/1")
    curve = page.get_by_role("slider", name="Depth over time")
    expect(page.get_by_role("list", name="Who swam")).to_contain_text("PID")
    expect(page.get_by_role("button", name=re.compile("Yellow card"))).to_be_visible()
    figures = page.get_by_role("region", name="Figures", exact=True)
    first = figures.get_by_role("button", name=re.compile("PID, 0.50 m"))
    expect(figures.get_by_role("row").filter(has_text="PID, 0.50 m")).to_contain_text("10.0")

    first.click()
    expect(first).to_have_attribute("aria-pressed", "true")
    expect(page).to_have_url(re.compile(r"from=2\.5&to=12\.5"))
    page.go_back()
    expect(first).to_have_attribute("aria-pressed", "false")

    curve.focus()
    curve.press("Home")
    for _ in range(2):
        curve.press("Shift+ArrowRight")
    moment = page.get_by_role("region", name="Moment")
    expect(curve).to_have_attribute("aria-valuetext", re.compile("^00:03, "))
    expect(moment.locator("b")).to_have_text("00:03")
    expect(moment).to_contain_text("Set point0.50")
    expect(page).to_have_url(re.compile(r"at=3\.4"))
    curve.press("Enter")
    expect(page).to_have_url(re.compile("#/replay/1"))


def test_a_range_is_drawn_and_has_figures(page: Page, dives: DiveSite) -> None:
    page.goto(f"{dives.url}/#/sessions/1")
    curve = page.get_by_role("slider", name="Depth over time")
    box = curve.bounding_box()
    assert box is not None
    middle = box["y"] + 60
    page.mouse.move(box["x"] + 0.4 * box["width"], middle)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.5 * box["width"], middle)
    page.mouse.move(box["x"] + 0.6 * box["width"], middle)
    page.mouse.up()
    row = page.get_by_role("row").filter(has_text="Chosen range")
    expect(row).to_contain_text(re.compile(r"6\.\d"))
    page.get_by_role("button", name="Zoom in").click()
    expect(page.get_by_role("button", name="Whole dive", exact=True)).to_be_visible()
    page.get_by_role("button", name="Clear range").click()
    expect(row).to_be_hidden()
    expect(page.get_by_role("button", name="Zoom in")).to_be_hidden()


def test_a_replay_is_sought_on_its_depth_profile(page: Page, dives: DiveSite) -> None:
    page.goto(f"{dives.url}/#/replay/1")
    slider = page.get_by_role("slider", name="Time since the start of the session")
    expect(slider).to_have_attribute("aria-valuetext", "00:00, 0.00 m")
    box = slider.bounding_box()
    assert box is not None
    slider.click(position={"x": box["width"] / 2, "y": 20})
    expect(slider).to_have_attribute("aria-valuetext", "00:17, 1.00 m")
    expect(page.get_by_label("Player").locator("strong")).to_have_text(re.compile(r"^00:17\.\d$"))
    slider.press("ArrowLeft")
    expect(slider).to_have_attribute("aria-valuetext", re.compile("^00:12, "))
    card = page.get_by_label("Player").get_by_role("button", name="Yellow card")
    expect(card).to_have_attribute("title", re.compile("^00:12 Yellow card"))
    card.click()
    expect(page).to_have_url(re.compile(r"#/replay/1\?.*\bat=12\.2\b"))


def test_a_moment_is_looked_at_in_curve_and_charts_of_a_replay_alike(page: Page, dives: DiveSite) -> None:
    page.goto(f"{dives.url}/#/replay/1?at=20")
    slider = page.get_by_role("slider", name="Time since the start of the session")
    chart = page.get_by_role("slider", name=re.compile("^Cursor in Depth and set point"))
    expect(slider).to_have_attribute("aria-valuetext", re.compile("^00:20, "))
    expect(chart).to_have_attribute("aria-valuetext", re.compile("^now: depth 1.00"))
    box = slider.bounding_box()
    assert box is not None
    slider.hover(position={"x": 10.0 / 35 * box["width"], "y": 20})
    expect(slider.locator("b")).to_have_text(re.compile("^00:(09|10), "))
    expect(chart).to_have_attribute("aria-valuetext", re.compile(r"^(9\.9|10\.\d) s ago: depth 0\.[45]\d"))
    slider.hover(position={"x": 30.0 / 35 * box["width"], "y": 20})
    expect(chart).to_have_attribute("aria-valuetext", re.compile("^now: "))

    box = chart.bounding_box()
    assert box is not None
    chart.hover(position={"x": box["width"] * 50 / 60, "y": 20})
    expect(slider.locator("b")).to_have_text(re.compile(r"^00:(09|10), 0\.[45]\d m$"))
    expect(slider).to_have_attribute("aria-valuetext", re.compile("^00:20, "))
    page.mouse.move(0, 0)
    expect(slider.locator("b")).to_be_hidden()


def test_layout_span_range_and_ends_are_in_the_address(page: Page, dives: DiveSite) -> None:
    page.goto(f"{dives.url}/#/replay/1?at=20&from=5&to=15&layout=sensors&span=30")
    layout, span = page.get_by_label("Layout of the panels"), page.get_by_label("Time shown").first
    expect(layout.locator("option:checked")).to_have_text("Sensors")
    expect(span).to_have_value("30")
    expect(page.get_by_text("Zoomed").first).to_be_visible()
    page.reload()
    expect(page.get_by_text("Zoomed").first).to_be_visible()
    expect(page).to_have_url(re.compile(r"\?at=20&from=5&to=15&layout=sensors&span=30$"))
    layout.select_option("Standard")
    expect(page).to_have_url(re.compile("layout=standard"))
    page.go_back()
    expect(layout.locator("option:checked")).to_have_text("Sensors")
    page.get_by_role("button", name="Resume").first.click()
    expect(page).to_have_url(re.compile(r"\?at=20&layout=sensors&span=30$"))

    page.goto(f"{dives.url}/#/replay/1?at=x&from=9&to=2&layout=nonsense&span=7&tab=%00")
    expect(span).to_have_value("60")
    expect(page).to_have_url(re.compile(r"\?at=0&layout=sensors&span=7&"))

    page.goto(f"{dives.url}/#/sessions/1/study?y-ends=-1,1&x-ends=nonsense")
    least, most = page.get_by_label("x, least", exact=True), page.get_by_label("y, most", exact=True)
    expect(page.get_by_label("y, least", exact=True)).to_have_value("-1")
    expect(least).to_have_value("")
    most.fill("2")
    most.press("Enter")
    expect(page).to_have_url(re.compile(r"y-ends=-1,2"))
    page.go_back()
    expect(most).to_have_value("1")


def test_the_signals_of_a_session_are_studied(page: Page, dives: DiveSite) -> None:
    page.goto(f"{dives.url}/#/sessions/1")
    page.get_by_role("link", name="Study", exact=True).click()
    expect(page.get_by_role("img", name="control, output against depth (m)")).to_be_visible()
    page.get_by_label("Across (x)").select_option("control.error")
    expect(page.get_by_role("img", name="control, output against control, error (m)")).to_be_visible()
    expect(page).to_have_url(re.compile(r"#/sessions/1/study\?x=control\.error$"))

    page.goto(f"{dives.url}/#/sessions/1/study?signals=motor.angle_0&from=5&to=30")
    expect(page.get_by_text(re.compile(r"strongest at 1\.2\d Hz, amplitude .* rad"))).to_be_visible()
    expect(page.get_by_role("img", name="Power spectral density")).to_be_visible()
    page.get_by_label("to", exact=True).fill("5.1")
    page.keyboard.press("Enter")
    expect(page.get_by_text("and a spectrum needs 32. Choose a longer range.")).to_be_visible()
    expect(page).to_have_url(re.compile(r"to=5\.1"))


@pytest.mark.parametrize(
    ("address", "sentence"),
    [
        ("1?from=x&to=3", "This address names a time that the session does not have (from=x, to=3)."),
        ("1?at=1e9", "This address names a time that the session does not have (at=1e9)."),
        ("2", "The robot was never armed in this session: there are no segments."),
        ("3", "This session has no samples."),
        ("3/study", "This session has no signals."),
        ("1/study?x=no.such", "This session has no signal no.such. It is passed over."),
    ],
)
def test_what_cannot_be_shown_is_said(page: Page, dives: DiveSite, address: str, sentence: str) -> None:
    page.goto(f"{dives.url}/#/sessions/{address}")
    expect(page.get_by_text(sentence)).to_be_visible()


@pytest.mark.parametrize("size", [DESKTOP, PHONE], ids=["desktop", "phone"])
def test_a_reader_studies_and_replays_a_dive_and_is_asked_for_nothing_else(
    browser: Browser, dives: DiveSite, size: ViewportSize
) -> None:
    asked = {"session": 1, "ends": time.time() + 3600}
    token = dives.api.post("/access/reading-links", json=asked).raise_for_status().json()["token"]
    with browser.new_context(viewport=size) as context:
        reader = context.new_page()
        answered: list[tuple[int, str]] = []
        reader.on("response", lambda response: answered.append((response.status, response.url)))
        reader.goto(f"{dives.url}/#/sessions/1/study?y-ends=-1,1&read={token}")
        expect(reader.get_by_role("img", name="control, output against depth (m)")).to_be_visible()
        expect(reader.get_by_label("y, least", exact=True)).to_have_value("-1")
        reader.get_by_role("link", name="Data", exact=True).click()
        expect(reader.get_by_role("button", name="Export")).to_have_count(0)
        reader.get_by_role("link", name="Dive", exact=True).click()
        expect(reader.get_by_role("button", name=re.compile("PID, 0.50 m"))).to_be_visible()
        reader.get_by_role("link", name="Replay", exact=True).click()
        slider = reader.get_by_role("slider", name="Time since the start of the session")
        slider.press("ArrowRight")
        expect(slider).to_have_attribute("aria-valuetext", re.compile("^00:05, "))
        expect(reader.get_by_role("button", name="Mark", exact=True)).to_have_count(0)
        expect(reader.get_by_role("button", name="STOP")).to_have_count(0)
        assert [(status, url) for status, url in answered if not 200 <= status < 300] == []
