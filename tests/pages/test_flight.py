"""The flight view: the picture fills the window, instruments over it; STOP stays where it is."""

import re
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, StorageState, ViewportSize, expect

from tests.browser.axe import AXE, faults
from tests.browser.opening import DESKTOP, LYING_PHONE, PHONE
from tests.pages.dive_site import DiveSite
from tests.pages.flying import Flown

SIZES = {"desktop": DESKTOP, "phone": PHONE, "lying phone": LYING_PHONE}
LAPTOP: ViewportSize = {"width": 1280, "height": 720}
"""The lowest desktop: with the charts in it, tools and inset have little height."""
READINGS = re.compile(r"Depth −?0\.00 m, heading \d{3}°, roll .+°, pitch .+°")
BY_ITSELF = "localStorage.setItem('mucat-flight', 'on')"
# Of what the instruments' canvas holds: whether it has this colour anywhere (red, green, blue).
HAS_COLOUR = """(colour) => {
    const canvas = document.querySelector('.instruments canvas');
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    for (let at = 0; at < data.length; at += 4) {
        if (colour.every((part, place) => data[at + place] === part) && data[at + 3] === 255) return true;
    }
    return false;
}"""
WHITE, HELD = [255, 255, 255], [255, 198, 92]
DENIED = """
const refuse = () => Promise.reject(new DOMException('no', 'NotAllowedError'));
Element.prototype.requestFullscreen = refuse;
Object.defineProperty(Document.prototype, 'fullscreenEnabled', { get: () => true });
Object.defineProperty(Navigator.prototype, 'wakeLock', { get: () => ({ request: refuse }) });
"""
GRANTED = """
globalThis.locks = 0;
const lock = { request: async () => { locks += 1; return { release: async () => { locks -= 1; } }; } };
Object.defineProperty(Navigator.prototype, 'wakeLock', { get: () => lock });
"""
MISSING = "delete Navigator.prototype.wakeLock"
# A full screen; `escape` ends it as a browser does by Esc, of which the page hears nothing.
FULL_SCREEN = """
let whole = null;
const change = (element) => { whole = element; document.dispatchEvent(new Event('fullscreenchange')); };
Object.defineProperty(Document.prototype, 'fullscreenElement', { get: () => whole });
Object.defineProperty(Document.prototype, 'fullscreenEnabled', { get: () => true });
Element.prototype.requestFullscreen = async function () { change(this); };
Document.prototype.exitFullscreen = async () => change(null);
globalThis.escape = () => change(null);
"""


def opened(
    browser: Browser, site: DiveSite, cookies: StorageState, size: ViewportSize, *scripts: str
) -> tuple[Page, Flown]:
    """Return a page at Operate whose robot can be flown, and that robot."""
    options: dict[str, Any] = {"has_touch": True, "is_mobile": True} if size != DESKTOP else {}
    context = browser.new_context(
        viewport=size, storage_state=cookies, reduced_motion="reduce", color_scheme="dark", **options
    )
    context.add_init_script(path=AXE)
    for script in (BY_ITSELF, *scripts):
        context.add_init_script(script)
    page = context.new_page()
    flown = Flown(page)
    page.goto(f"{site.url}/#/operate")
    expect(page.get_by_role("button", name="Control: you have control")).to_be_visible()
    return page, flown


@pytest.fixture(params=list(SIZES.values()), ids=list(SIZES))
def flying(
    request: pytest.FixtureRequest, browser: Browser, site: DiveSite, cookies: StorageState, _at_rest: None
) -> Iterator[tuple[Page, Flown]]:
    """The flight view, which has come by itself, and the robot that it shows."""
    page, flown = opened(browser, site, cookies, request.param, GRANTED)
    flown.mode = "manual"
    expect(page.get_by_role("heading", name="Flight view")).to_be_attached()
    flown.show()
    yield page, flown
    page.context.close()


@pytest.fixture
def desk(
    browser: Browser, site: DiveSite, cookies: StorageState, _at_rest: None, request: pytest.FixtureRequest
) -> Iterator[tuple[Page, Flown]]:
    """Operate on a desktop, where these scripts came first."""
    page, flown = opened(browser, site, cookies, DESKTOP, *getattr(request, "param", ()))
    yield page, flown
    page.context.close()


def test_picture_and_instruments_fill_the_window(flying: tuple[Page, Flown]) -> None:
    page, flown = flying
    width, height = page.evaluate("[innerWidth, innerHeight]")
    picture = page.get_by_role("img", name="Camera")
    expect(picture).to_be_visible()
    assert page.evaluate("getComputedStyle(document.querySelector('.picture img')).objectFit") == "contain"
    expect(page.get_by_role("img", name=READINGS)).to_be_visible()
    page.wait_for_function(HAS_COLOUR, arg=WHITE)
    # Nothing holds the depth: no set point.
    assert not page.evaluate(HAS_COLOUR, HELD)
    stop = page.get_by_role("button", name="STOP")
    box = stop.bounding_box()
    assert box is not None
    assert box["x"] + box["width"] > width - 20
    assert box["y"] < 20
    assert page.evaluate("document.documentElement.scrollHeight") <= height
    # The state comes each second.
    flown.held = {"depth"}
    page.wait_for_function(HAS_COLOUR, arg=HELD)
    flown.alarms = [{}]
    alarm = page.get_by_role("group", name="Alarms")
    expect(alarm).to_contain_text("The camera sends no pictures.")
    with page.expect_response("**/commands/acknowledge"):
        alarm.get_by_role("button", name="Acknowledge").click()
    assert faults(page) == []
    stop.click()
    expect(stop).to_have_text("Stopped")


def test_panels_slide_in_and_one_press_swaps_the_views(flying: tuple[Page, Flown]) -> None:
    page, flown = flying
    for title, inside in (("Controls", "Arm"), ("Charts and console", "Console")):
        expect(page.get_by_role("region", name=inside, exact=True)).to_have_count(0)
        page.get_by_role("button", name=title, exact=True).press("Enter")
        expect(page.get_by_role("region", name=inside, exact=True)).to_be_visible()
        expect(page.get_by_role("button", name="STOP")).to_be_visible()
        if page.viewport_size in (DESKTOP, LAPTOP):
            page.set_viewport_size(LAPTOP)
            for tool in page.get_by_role("toolbar", name="Flight view").get_by_role("button").all():
                tool.click(trial=True)
        page.get_by_role("button", name=f"Close {title}").press("Enter")
        expect(page.get_by_role("region", name=inside, exact=True)).to_have_count(0)
    swap = page.get_by_role("button", name="Swap: show the model large")
    expect(swap).to_contain_text("model")
    swap.click()
    expect(page.get_by_role("img", name="The robot: roll")).to_be_visible()
    expect(page.locator(".facts")).to_contain_text("model")
    page.get_by_role("button", name="Swap: show the camera large").click()
    flown.scene = True
    page.reload()
    page.get_by_role("button", name="Swap: show the bystander large").click()
    expect(page.get_by_role("application")).to_be_visible()
    flown.show("observer")
    expect(page.get_by_role("img", name="The robot in the simulated water")).to_be_visible()


def test_notices_lie_over_neither_each_other_nor_tools(flying: tuple[Page, Flown], site: DiveSite) -> None:
    page, _ = flying
    site.api.post("/sessions", json={"name": "noticed"}).raise_for_status()
    expect(page.get_by_role("button", name=re.compile("^REC"))).to_be_visible()
    page.keyboard.press("m")
    page.keyboard.press("p")
    for name in ("Bookmark", "Snapshots"):
        page.get_by_role("region", name=name, exact=True).get_by_role("button", name="Close").click(
            trial=True
        )
    for tool in page.get_by_role("toolbar", name="Flight view").get_by_role("button").all():
        tool.click(trial=True)


@pytest.mark.parametrize("desk", [[GRANTED]], indirect=True)
def test_it_goes_with_the_driving(desk: tuple[Page, Flown]) -> None:
    page, flown = desk
    flown.mode = "manual"
    expect(page.get_by_role("heading", name="Flight view")).to_be_attached()
    flown.mode = "automatic"
    expect(page.get_by_role("heading", name="Operate")).to_be_attached()
    assert page.evaluate("locks") == 1, "this page has control: the screen stays on"


def test_keys_light_up_and_whoever_leaves_is_not_taken_back(desk: tuple[Page, Flown]) -> None:
    page, flown = desk
    flown.mode = "manual"
    caps = page.get_by_role("group", name="Keys")
    expect(caps).to_be_visible()
    # F drives now.
    page.keyboard.down("f")
    expect(caps.get_by_text("F", exact=True)).to_have_class(re.compile("down"))
    page.keyboard.up("f")
    page.keyboard.press("v")
    expect(page.get_by_role("heading", name="Operate")).to_be_attached()
    page.get_by_role("link", name="Tune").click()
    expect(page.get_by_role("heading", name="Tune")).to_be_attached()
    page.get_by_role("link", name="Operate").click()
    expect(page.get_by_role("region", name="Drive")).to_be_visible()
    assert re.search(r"#/operate(\?|$)", page.url)


def test_key_button_and_double_press_open_it_and_esc_is_stop(
    desk: tuple[Page, Flown], site: DiveSite
) -> None:
    page, flown = desk
    title = page.get_by_role("heading", name="Flight view")
    page.keyboard.press("f")
    expect(title).to_be_attached()
    before = len(site.commands)
    page.keyboard.press("Escape")
    expect(page.get_by_role("button", name="Stopped")).to_be_visible()
    assert any(name == "stop" for name, _ in site.commands[before:])
    expect(title).to_be_attached()
    page.keyboard.press("f")
    expect(title).to_have_count(0)
    flown.show()
    page.get_by_role("region", name="Camera").locator("figure").dblclick()
    expect(title).to_be_attached()
    page.get_by_role("link", name="Leave").click()
    page.get_by_role("region", name="Camera").get_by_role("link", name="Flight view").click()
    expect(title).to_be_attached()


def test_a_switch_keeps_it_from_coming_by_itself(desk: tuple[Page, Flown]) -> None:
    page, flown = desk
    page.get_by_role("button", name="Page settings").click()
    page.get_by_label("Flight view while armed in manual").uncheck()
    flown.mode = "manual"
    expect(page.get_by_role("region", name="Drive")).to_be_visible()
    assert re.search(r"#/operate(\?|$)", page.url)


def test_a_picture_that_stops_is_said(desk: tuple[Page, Flown]) -> None:
    page, flown = desk
    page.keyboard.press("f")
    expect(page.get_by_text("No picture yet")).to_be_visible()
    flown.camera_failure = "No picture: the camera /dev/video0 gives no picture; check its plug."
    page.reload()
    notice = page.locator(".over").get_by_role("alert")
    expect(notice).to_have_text(flown.camera_failure)
    flown.show()
    expect(notice).to_have_text(f"The camera’s picture has stopped. {flown.camera_failure}")
    expect(page.get_by_text("picture 1.")).to_be_visible()
    assert "grayscale" in page.evaluate("getComputedStyle(document.querySelector('.picture')).filter")
    expect(page.get_by_role("img", name=READINGS)).to_be_visible()
    flown.camera_failure = None
    flown.show()
    expect(notice).to_have_count(0)


@pytest.mark.parametrize("desk", [[DENIED]], indirect=True)
def test_what_the_browser_denies_is_said(desk: tuple[Page, Flown]) -> None:
    page, _ = desk
    page.keyboard.press("f")
    page.get_by_role("button", name="Full screen").click()
    expect(page.get_by_text("The browser refused the full screen.")).to_be_visible()
    dark = page.get_by_role("main").get_by_text("the browser refused to keep it on")
    expect(dark).to_be_visible()
    page.get_by_role("button", name="Close note").click()
    expect(dark).to_have_count(0)


@pytest.mark.parametrize("desk", [[MISSING]], indirect=True)
def test_a_browser_without_wake_lock_is_said(desk: tuple[Page, Flown]) -> None:
    page, _ = desk
    page.keyboard.press("f")
    expect(page.get_by_role("main").get_by_text("this browser cannot keep it on")).to_be_visible()


@pytest.mark.parametrize("desk", [[FULL_SCREEN, "delete Navigator.prototype.keyboard"]], indirect=True)
def test_the_browsers_own_end_of_the_full_screen_is_stop(desk: tuple[Page, Flown]) -> None:
    page, _ = desk
    page.keyboard.press("f")
    whole = page.get_by_role("button", name="Full screen")
    whole.click()
    expect(whole).to_have_attribute("aria-pressed", "true")
    whole.click()
    expect(whole).to_have_attribute("aria-pressed", "false")
    expect(page.get_by_role("button", name="STOP")).to_be_visible()
    whole.click()
    page.evaluate("escape()")
    expect(page.get_by_role("button", name="Stopped")).to_be_visible()
