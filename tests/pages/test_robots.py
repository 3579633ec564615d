"""The page of a lab's robots: tiles, STOP all, removal, and the empty lab."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser.opening import DESKTOP
from tests.browser.people import follow, make_link
from tests.pages.lab_site import SWIMMING, LabSite, presence


@contextmanager
def operator(browser: Browser, lab: LabSite) -> Iterator[Page]:
    """The first page of a lab, in the browser of an operator who has just signed in."""
    with browser.new_context(viewport=DESKTOP) as context:
        page = context.new_page()
        follow(page, make_link(lab, "operator"))
        expect(page.get_by_role("heading", name="Robots")).to_be_visible()
        yield page


@pytest.fixture
def lab(tmp_path: Path) -> Iterator[LabSite]:
    with LabSite(tmp_path, {"turtle-1": SWIMMING, "turtle-2": presence()}, ("turtle-3",)) as lab:
        yield lab


@pytest.fixture
def robots(browser: Browser, lab: LabSite) -> Iterator[Page]:
    with operator(browser, lab) as page:
        yield page


def test_each_robot_has_a_tile_and_stop_reaches_them_all(robots: Page, lab: LabSite) -> None:
    tiles = {name: robots.get_by_role("article", name=name) for name in ("turtle-1", "turtle-2", "turtle-3")}
    swimming, resting, away = tiles.values()
    expect(swimming).to_contain_text("Armed")
    for text in ("Connected", "AUTO", "1.23", "Survey of the pool, 42 %", "2026-11-24 dive", "20.00 GB"):
        expect(swimming).to_contain_text(text)
    expect(swimming).to_contain_text("The battery is low.")
    link = swimming.get_by_role("link", name="Open the page of turtle-1")
    expect(link).to_have_attribute("href", "https://turtle-1.local:8000")
    expect(resting).to_contain_text("Ready")
    expect(away).to_contain_text("Not seen since the lab started")
    expect(robots.get_by_text("2 of 3 connected")).to_be_visible()

    expect(resting).to_contain_text("No session yet")
    expect(resting).to_contain_text("open to no other computer")
    robots.get_by_role("button", name="STOP all").click()
    expect(swimming).to_contain_text("Stopped (Zenoh)")
    expect(resting).to_contain_text("Stopped (Zenoh)")
    expect(away.get_by_role("alert").filter(has_text="Has not answered STOP")).to_contain_text(
        "Its page is open to no other computer."
    )
    expect(robots.get_by_role("button", name="2 of 3 stopped")).to_be_visible()
    assert [lab.ends[name].stopped for name in ("turtle-1", "turtle-2")] == [1, 1]
    # From every page of the lab.
    robots.get_by_role("link", name="Figures").click()
    expect(robots.get_by_role("heading", name="Figures")).to_be_visible()
    with robots.expect_response("**/api/robots/stop"):
        robots.keyboard.press("Escape")
    assert [lab.ends[name].stopped for name in ("turtle-1", "turtle-2")] == [2, 2]
    missing = robots.get_by_role("alert").filter(has_text="Not stopped: turtle-3.")
    missing.get_by_role("link", name="Robots").click()
    missing.get_by_role("button", name="Close").click()
    expect(missing).to_be_hidden()

    away.get_by_role("button", name="Remove turtle-3 from the lab").click()
    away.get_by_role("button", name="Remove", exact=True).click()
    expect(away).to_be_hidden()
    expect(swimming).to_contain_text("Connected")


def test_an_empty_lab_says_how_a_robot_joins(browser: Browser, tmp_path: Path) -> None:
    with LabSite(tmp_path, {}) as lab, operator(browser, lab) as page:
        expect(page.get_by_text("No robot has joined yet")).to_be_visible()
        page.get_by_role("button", name="Make a code").click()
        # This lab has no TLS.
        expect(page.get_by_role("alert").filter(has_text="server.tls = true")).to_be_visible()
        page.get_by_role("link", name="Sessions", exact=True).click()
        page.get_by_role("link", name="Open Robots").click()
        expect(page.get_by_text("No robot has joined yet")).to_be_visible()
