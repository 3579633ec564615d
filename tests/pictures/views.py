"""Acts of a person on a page before its picture is taken."""

import re

from playwright.sync_api import Page, expect

from tests.browser.arranging import arrange, handle
from tests.browser.bringing_up import PagePerson
from tests.browser.driving import hold_to_arm
from tests.browser.pages import settle
from tests.browser.site import Site
from tests.stack import Stack
from tests.waiting import wait_for

STREAMED = "() => [...document.images].some((one) => one.naturalWidth >= 320)"


def leave(_: Page, __: Site) -> None:
    """Leave it as it opens."""


def see(page: Page, _: Site) -> None:
    """Wait for the camera's stream."""
    page.wait_for_function(STREAMED)


def open_help(page: Page, _: Site) -> None:
    page.get_by_role("link", name="Help for this page").click()
    chapter = page.get_by_role("region", name="Help").frame_locator("iframe")
    expect(chapter.get_by_role("heading", level=1)).to_be_visible()


def be_guided(page: Page, site: Site) -> None:
    """Have the card of the first dive, which this browser has put away."""
    open_help(page, site)
    page.get_by_role("button", name="First dive").click()
    expect(page.get_by_role("region", name="First dive")).to_be_visible()
    see(page, site)


def await_figures(page: Page, site: Site) -> None:
    """Wait until the lab has computed those of all sessions."""
    sessions = len(site.api.get("/sessions").json())

    def is_whole() -> bool:
        page.reload()
        settle(page)
        if page.get_by_text("still to be measured").count() > 0:
            return False
        return page.get_by_text(f"of {sessions} sessions").count() > 0

    wait_for(is_whole, "the figures of all sessions")


def arrange_panels(page: Page, _: Site) -> None:
    page.wait_for_function(STREAMED)
    arrange(page)
    handle(page, "Camera").focus()


def try_mission(page: Page, _: Site) -> None:
    page.get_by_role("button", name="Start the dry run").click()
    expect(page.get_by_text("20 of 20", exact=True)).to_be_visible()


def write_scenario(page: Page, _: Site) -> None:
    page.get_by_role("radio", name=re.compile("^Hover in a current")).check()
    page.get_by_role("button", name="Edit", exact=True).click()
    expect(page.get_by_role("textbox").first).to_be_visible()


def choose_runs(page: Page, _: Site) -> None:
    """Lay the measured steps over the prediction."""
    for run in page.get_by_role("checkbox", name=re.compile("^Show #")).all():
        run.check()
    page.get_by_role("combobox", name="Controller").select_option("pid")
    expect(page.get_by_text(re.compile("^Dotted"))).to_be_visible()
    page.get_by_role("heading", level=1).scroll_into_view_if_needed()


def give_control_away(page: Page, site: Site) -> None:
    """Look on, as visitors do."""
    site.api.post("/control/take", params={"over": True}).raise_for_status()
    expect(page.get_by_role("button", name="STOP")).to_be_hidden()


def swap_pictures(page: Page, _: Site) -> None:
    page.get_by_role("button", name="Swap: show the bystander large").click()
    page.wait_for_function("() => document.querySelector('.stage img')?.naturalWidth > 0")


def see_curve(page: Page, _: Site) -> None:
    page.get_by_role("region", name="Depth", exact=True).evaluate(
        "(panel) => panel.scrollIntoView({ block: 'start' })"
    )


def see_mission(page: Page, _: Site) -> None:
    page.get_by_role("region", name="Mission").evaluate("(panel) => panel.scrollIntoView({ block: 'start' })")


def drive_by_hand(page: Page, _: Site) -> None:
    """Arm in manual, which opens the flight view."""
    page.get_by_role("button", name="Manual", exact=True).click()
    hold_to_arm(page, page.get_by_role("toolbar", name="Flight view"))
    page.wait_for_function(STREAMED)


def lie_down(page: Page, site: Site) -> None:
    """Open the bring-up's step at which the hull is laid down."""
    _bring_up(page, site).open("axes")


def turn_fin(page: Page, site: Site) -> None:
    """Open the bring-up's step at which a fin is turned by hand."""
    _bring_up(page, site).open("fin_0")


def _bring_up(page: Page, site: Site) -> PagePerson:
    assert isinstance(site, Stack)
    person = PagePerson(page, site)
    if site.api.get("/bring-up").json()["phase"] == "idle":
        person.begin()
    return person
