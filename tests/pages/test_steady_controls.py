"""The button that arms: it stays where it is while data arrives, and says why holding it does nothing."""

from collections.abc import Iterator
from dataclasses import replace

import pytest
from playwright.sync_api import Browser, Page, StorageState, ViewportSize, WebSocketRoute, expect

from robot_runtime.clock import SteadyClock
from robot_runtime.contract.documents import Mission
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block, pack_documents
from tests.browser.opening import LYING_PHONE, PHONE, SMALL_PHONE
from tests.pages.dive_site import DiveSite

# Every frame, from the first on: the places where the button has been.
FOLLOW = """
globalThis.places = [];
const follow = () => {
    const buttons = [...document.querySelectorAll('button')];
    const button = buttons.find((one) => one.textContent.trim() === 'Hold to arm');
    if (button !== undefined) {
        const { x, y, width, height } = button.getBoundingClientRect();
        const place = [x, y, width, height].map(Math.round).join(' ');
        if (globalThis.places.at(-1) !== place) globalThis.places.push(place);
    }
    requestAnimationFrame(follow);
};
requestAnimationFrame(follow);
"""
ENDED = Mission(
    time=0.0,
    number=1,
    sequence=0,
    name="two_depths",
    title="Two depths",
    phase="complete",
    text="",
    elapsed=60.0,
    remaining=0.0,
    progress=1.0,
    paused=0.0,
    pause=300.0,
    deepest=1.0,
    steps=[],
)


def ended_mission() -> bytes:
    """The block of a mission that has just ended."""
    mission = [replace(ENDED, time=SteadyClock().now())]
    return Block.of(BY_NAME["mission"], 1, 0, pack_documents(mission)).data


@pytest.fixture(params=[PHONE, SMALL_PHONE, LYING_PHONE], ids=["phone", "small", "lying"])
def phone(
    request: pytest.FixtureRequest, browser: Browser, cookies: StorageState, _at_rest: None
) -> Iterator[Page]:
    """A phone whose page is not open yet."""
    size: ViewportSize = request.param
    context = browser.new_context(viewport=size, storage_state=cookies, has_touch=True, is_mobile=True)
    page = context.new_page()
    page.add_init_script(FOLLOW)
    yield page
    context.close()


def test_the_button_to_arm_stays_where_it_is(phone: Page, site: DiveSite) -> None:
    sockets: list[WebSocketRoute] = []

    def hand_on(socket: WebSocketRoute) -> None:
        sockets.append(socket)
        socket.connect_to_server()

    phone.route_web_socket("**/api/live", hand_on)
    phone.goto(site.url)
    manual = phone.get_by_role("button", name="Manual", exact=True)
    # Playwright itself scrolls to a button that it has found disabled.
    expect(manual).to_be_enabled()
    manual.click()
    expect(phone.get_by_role("region", name="Arm").get_by_text("Ready to arm")).to_be_visible()
    sockets[-1].send(ended_mission())
    expect(phone.get_by_role("region", name="Mission")).to_contain_text("Two depths")
    assert len(phone.evaluate("places")) == 1, phone.evaluate("places")
