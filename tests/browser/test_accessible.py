"""Every page, and what opens on it, looked at by axe-core for those who see badly or have no pointer."""

from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, StorageState, expect

from tests.browser.conftest import DESKTOP, PHONE
from tests.browser.pages import PAGES, View, fill, settle, show
from tests.browser.people import make_link
from tests.stack import ROOT, Stack

AXE = ROOT / "frontend/node_modules/axe-core/axe.min.js"
USUAL = "document, { resultTypes: ['violations'] }"
FOR_SUNLIGHT = "{ exclude: ['.stale', '.away', '.old'] }, { runOnly: ['color-contrast-enhanced'] }"
"""7:1, but for what is too old to be trusted. Colours are all that differs in that theme."""
WIDTHS = (390, 768, 1024, 1280, 1440, 1920)
GRAVE = {"serious", "critical"}
OPENED = ("Control:", "Record", "Alarms")
"""Beginnings of the names of what opens from the bar."""


@pytest.fixture(scope="module", params=[DESKTOP, PHONE], ids=["desktop", "phone"])
def seen(
    request: pytest.FixtureRequest, browser: Browser, stack: Stack, cookies: StorageState
) -> Iterator[Page]:
    """One page for all of these tests; nothing is changed by them."""
    fill(stack)
    context = browser.new_context(
        viewport=request.param,
        storage_state=cookies,
        has_touch=request.param == PHONE,
        reduced_motion="reduce",
    )
    page = context.new_page()
    context.add_init_script(path=AXE)
    page.goto(stack.url)
    yield page
    context.close()


def faults(page: Page, how: str = USUAL) -> list[str]:
    """What is wrong on the page as it is now, for a person: the rule, and where."""
    found: dict[str, Any] = page.evaluate(f"axe.run({how})")
    return [
        f"{fault['id']}: {fault['help']}: {node['target']} {node.get('failureSummary', '')}"
        for fault in found["violations"]
        if fault["impact"] in GRAVE
        for node in fault["nodes"][:3]
    ]


@pytest.mark.parametrize("view", PAGES, ids=lambda view: view.name)
def test_no_page_has_a_grave_fault(seen: Page, stack: Stack, view: View) -> None:
    show(seen, stack, view)
    dark = faults(seen)
    seen.evaluate("document.documentElement.dataset.theme = 'sunlight'")
    sunlight = faults(seen, FOR_SUNLIGHT)
    seen.evaluate("document.documentElement.dataset.theme = 'dark'")
    assert dark + sunlight == []


def test_what_opens_from_the_bar_has_none(seen: Page, stack: Stack) -> None:
    show(seen, stack, PAGES[0])
    for name in OPENED:
        opener = seen.get_by_role("banner").get_by_role("button", name=name).first
        if opener.count() == 0:
            continue
        opener.click()
        expect(opener).to_have_attribute("aria-expanded", "true")
        assert faults(seen) == [], name
        opener.click()


@pytest.mark.parametrize("width", WIDTHS)
def test_the_bar_has_room_and_stop_is_there_at_every_width(seen: Page, stack: Stack, width: int) -> None:
    size = seen.viewport_size
    assert size is not None
    seen.set_viewport_size({"width": width, "height": size["height"]})
    show(seen, stack, PAGES[0])
    bar = seen.get_by_role("banner")
    outside = seen.evaluate(
        """() => [...document.querySelectorAll('header.top :is(a, button, span, time), nav a')]
            .filter((one) => one.checkVisibility() && !one.closest('.visually-hidden, [hidden]'))
            .filter((one) => one.getBoundingClientRect().right > innerWidth + 0.5)
            .map((one) => one.textContent.trim())"""
    )
    squeezed = bar.evaluate(
        "(bar) => [bar, ...bar.children].some((one) => one.scrollWidth > one.clientWidth + 1)"
    )
    stop = seen.get_by_role("button", name="STOP").bounding_box()
    seen.set_viewport_size(size)
    assert (outside, squeezed) == ([], False)
    assert stop is not None
    assert min(stop["width"], stop["height"]) >= 44


def test_signing_in_has_none(browser: Browser, stack: Stack) -> None:
    context = browser.new_context(viewport=PHONE)
    page = context.new_page()
    context.add_init_script(path=AXE)
    page.goto(stack.url)
    expect(page.get_by_role("heading", name="Sign in")).to_be_visible()
    wrong = faults(page)
    context.close()
    assert wrong == []


def test_a_viewer_is_told_before_he_tries(browser: Browser, stack: Stack) -> None:
    context = browser.new_context(viewport=DESKTOP)
    page = context.new_page()
    context.add_init_script(path=AXE)
    page.goto(make_link(stack, "viewer"))
    expect(page.get_by_text("You are looking on.")).to_be_visible()
    refused = {
        "sessions": ["Delete", "Start recording", "Import…"],
        "scenarios": ["Run it"],
        "comm-tests": ["Start the test"],
        "system": ["Download a backup", "Hold to check the fins"],
        "operate": ["Hold to arm"],
    }
    for place, names in refused.items():
        page.goto(f"{stack.url}/#/{place}")
        for name in names:
            expect(page.get_by_role("button", name=name).first).to_be_disabled()
    expect(page.get_by_role("button", name="STOP")).to_be_enabled()
    settle(page)
    wrong = faults(page)
    context.close()
    assert wrong == []
