"""Accessibility of pages that show a live robot, checked by axe-core; tests/pages has the others."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, StorageState, expect

from tests.browser.axe import AXE, faults, faults_of_view, opened_for_axe
from tests.browser.driving import hold_to_arm
from tests.browser.opening import DESKTOP, PHONE
from tests.browser.pages import LIVE, PAGES, View, settle, show
from tests.browser.people import follow, make_link
from tests.stack import Stack

WIDTHS = (360, 390, 768, 1024, 1280, 1366, 1440, 1920)
CROWDED = """async (width) => {
    // What is there for a width alone comes and goes with the next frame.
    for (let frame = 0; frame < 2 || innerWidth !== width; frame++) await new Promise(requestAnimationFrame);
    const said = '[aria-label=Pages] a, .foot .opener, .top .program, .top .states > *, .top .row > *, .stop';
    const all = document.querySelectorAll(said);
    const seen = [...all].filter((one) => one.checkVisibility() && !one.matches('.visually-hidden'));
    const boxes = seen.map((one) => [one.textContent.trim(), one.getBoundingClientRect()]);
    const stop = document.querySelector('.stop').getBoundingClientRect();
    const out = ({ left, right }) => left < -0.5 || right > innerWidth + 0.5;
    const beside = (one, other) => one.right <= other.left + 1 || one.bottom <= other.top + 1;
    const covers = ([, one], [, other]) => !beside(one, other) && !beside(other, one);
    return [
        ...boxes.filter(([, box]) => out(box)).map(([text]) => `${text} is outside`),
        ...boxes.flatMap((box, at) => boxes.slice(at + 1).filter((other) => covers(box, other))
            .map(([text]) => `${box[0]} on ${text}`)),
        ...(Math.min(stop.width, stop.height) < 44 ? ['STOP is small'] : []),
    ];
}"""
"""What of the bar's words and buttons lies outside the window or on another one."""
OPENED = ("Control:", "Record", "Alarms", "Page settings")
"""Beginnings of the names of what opens from the bar."""


@pytest.fixture(scope="module", params=[DESKTOP, PHONE], ids=["desktop", "phone"])
def seen(
    request: pytest.FixtureRequest, browser: Browser, stack: Stack, cookies: StorageState
) -> Iterator[Page]:
    """One page for all of these tests; none of them changes anything."""
    with opened_for_axe(browser, stack, cookies, request.param) as page:
        yield page


@pytest.mark.parametrize("view", LIVE, ids=lambda view: view.name)
def test_no_page_has_a_serious_accessibility_violation(seen: Page, stack: Stack, view: View) -> None:
    assert faults_of_view(seen, stack, view) == []


def test_a_saved_profile_has_no_serious_violation(seen: Page, stack: Stack) -> None:
    stack.wait_ready()
    saved = stack.api.post("/profiles", json={"name": "seen"}).raise_for_status().json()["id"]
    (parameters,) = (view for view in LIVE if view.name == "tune-parameters")
    show(seen, stack, parameters)
    expect(seen.get_by_role("link", name="Download seen")).to_be_visible()
    result = faults(seen)
    stack.api.delete(f"/profiles/{saved}").raise_for_status()
    assert result == []


def test_menus_of_the_bar_have_no_serious_violation(seen: Page, stack: Stack) -> None:
    show(seen, stack, PAGES[0])
    for name in OPENED:
        opener = seen.get_by_role("button", name=name).first
        opener.click()
        expect(opener).to_have_attribute("aria-expanded", "true")
        assert faults(seen) == [], name
        opener.click()


def test_the_bar_shows_all_its_contents_and_stop_at_every_width(seen: Page, stack: Stack) -> None:
    show(seen, stack, PAGES[0])
    size = seen.viewport_size
    assert size is not None
    session = stack.api.post("/sessions", json={"name": "with a bar"}).json()["id"]
    hold_to_arm(seen)
    expect(seen.get_by_role("banner").get_by_title("Recording “with a bar”")).to_be_visible()
    crowded = {}
    for width in WIDTHS:
        seen.set_viewport_size({"width": width, "height": size["height"]})
        crowded[width] = seen.evaluate(CROWDED, width)
    seen.set_viewport_size(size)
    seen.get_by_role("button", name="STOP").click()
    stack.api.post(f"/sessions/{session}/stop").raise_for_status()
    assert crowded == {width: [] for width in WIDTHS}


def test_a_viewer_sees_the_reason_before_an_attempt(browser: Browser, stack: Stack) -> None:
    # An armed robot stops by itself where the computer holds it up; the button is then another one.
    stack.calm()
    context = browser.new_context(viewport=DESKTOP, color_scheme="dark")
    page = context.new_page()
    context.add_init_script(path=AXE)
    follow(page, make_link(stack, "viewer"))
    expect(page.get_by_text("View only.")).to_be_visible()
    refused = {
        "sessions": ["Delete", "Start recording", "Import…"],
        "scenarios": ["Run in simulation"],
        "comm-tests": ["Start the test"],
        "system": ["Download a backup", "Hold to check the fins"],
        "operate": ["Hold to arm"],
    }
    for position, names in refused.items():
        page.goto(f"{stack.url}/#/{position}")
        for name in names:
            expect(page.get_by_role("button", name=name).first).to_be_disabled()
    expect(page.get_by_role("button", name="STOP")).to_be_enabled()
    settle(page)
    wrong = faults(page)
    context.close()
    assert wrong == []
