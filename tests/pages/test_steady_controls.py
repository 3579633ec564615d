"""The button that arms: it stays where it is while data arrives, and says why holding it does nothing."""

import json
from collections.abc import Iterator
from dataclasses import replace

import pytest
from playwright.sync_api import Browser, Locator, Page, StorageState, ViewportSize, WebSocketRoute, expect

from robot_runtime.clock import SteadyClock
from robot_runtime.contract.documents import Mission
from robot_runtime.contract.topics import BY_ID, BY_NAME
from robot_runtime.transport.blocks import HEADER, Block, pack_documents
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
    phase="succeeded",
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
    """Return the block of a mission that has just ended."""
    mission = [replace(ENDED, time=SteadyClock().now())]
    return Block.of(BY_NAME["mission"], 1, 0, pack_documents(mission)).data


REASON = "The depth sensor is silent."


class Refusals:
    """Has the page read this `reason` against arming in each state of the robot; None: as the robot says."""

    def __init__(self, page: Page) -> None:
        self.reason: str | None = None
        page.route_web_socket("**/api/live", self._hand_on)

    def _hand_on(self, socket: WebSocketRoute) -> None:
        def hand_on(message: str | bytes) -> None:
            socket.send(self._change(message) if isinstance(message, bytes) else message)

        socket.connect_to_server().on_message(hand_on)

    def _change(self, message: bytes) -> bytes:
        changed = b""
        while message:
            topic, _, count, first, size = HEADER.unpack_from(message)
            payload, message = message[HEADER.size : HEADER.size + size], message[HEADER.size + size :]
            if topic == BY_NAME["state"].id and self.reason is not None:
                states = [document | {"refusals": [self.reason]} for document in json.loads(payload)]
                payload = json.dumps(states).encode()
            changed += Block.of(BY_ID[topic], count, first, payload).data
        return changed


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


def test_a_reason_that_goes_away_while_the_button_is_held_does_not_arm(phone: Page, site: DiveSite) -> None:
    """Nobody arms by a press that began while arming was not possible; and the button says so."""
    refusals, before = Refusals(phone), len(site.commands)
    refusals.reason = REASON
    phone.goto(site.url)
    panel = phone.get_by_role("region", name="Arm")
    expect(panel.get_by_text(REASON)).to_be_in_viewport(ratio=1)
    button = panel.get_by_role("button").last
    expect(button).to_have_text("Hold to arm")
    button.hover()
    phone.mouse.down()
    expect(button).to_have_text("Not now: see below")
    refusals.reason = None
    expect(panel.get_by_text("Ready to arm")).to_be_visible()
    expect(button).to_have_text("Release, then hold again")
    phone.mouse.up()
    expect(button).to_have_text("Hold to arm")
    assert "arm" not in [name for name, _ in site.commands[before:]]
    # Answered: a command that comes later would be one of the next test.
    with phone.expect_response("**/commands/arm"):
        phone.mouse.down()


ENDS = {
    "Esc": "window.dispatchEvent(new KeyboardEvent('keydown', { key: 'Escape' }))",
    "STOP by another finger": "document.querySelector('button.stop').click()",
    "another page": "location.hash = '#/people'",
}
"""Ends of a hold while the pointer stays down."""
# In one turn: on a busy computer the hold could be over before its end comes.
HOLD_AND_END = """(button) => {
    button.dispatchEvent(new PointerEvent('pointerdown', { button: 0, bubbles: true }));
    %s;
}"""
# What the page asks the server for from now on.
FOLLOW_REQUESTS = """() => {
    const fetch = globalThis.fetch;
    globalThis.asked = [];
    globalThis.fetch = (address, options) => (globalThis.asked.push(`${address}`), fetch(address, options));
}"""
# The button's own frame comes before this one.
FRAMES_OF_A_HOLD = """async () => {
    const begun = performance.now();
    while (performance.now() - begun < 800) await new Promise(requestAnimationFrame);
    return globalThis.asked;
}"""
# No frame is drawn, so a hold does not end, until `drawOn` is called.
DRAW_NOTHING = """() => {
    const draw = globalThis.requestAnimationFrame, awaited = [];
    globalThis.requestAnimationFrame = (frame) => awaited.push(frame);
    globalThis.drawOn = () => {
        globalThis.requestAnimationFrame = draw;
        for (const frame of awaited) draw(frame);
    };
}"""


def open_to_arm(page: Page, site: DiveSite) -> Locator:
    """Return the button to arm, once it would."""
    page.goto(f"{site.url}/#/operate")
    panel = page.get_by_role("region", name="Arm")
    expect(panel.get_by_text("Ready to arm")).to_be_visible()
    page.evaluate(FOLLOW_REQUESTS)
    return panel.get_by_role("button").last


def asks_to_arm(page: Page) -> bool:
    """Return True if the page has asked to arm, once a hold would have armed."""
    return any(address.endswith("/commands/arm") for address in page.evaluate(FRAMES_OF_A_HOLD))


@pytest.mark.parametrize("end", ENDS)
def test_a_hold_that_was_ended_does_not_arm(unopened: Page, site: DiveSite, end: str) -> None:
    button = open_to_arm(unopened, site)
    button.evaluate(HOLD_AND_END % ENDS[end])
    if end != "another page":
        expect(button).to_have_text("Release, then hold again")
    assert not asks_to_arm(unopened)


def test_a_reason_that_comes_and_goes_during_a_hold_does_not_arm(unopened: Page, site: DiveSite) -> None:
    refusals = Refusals(unopened)
    button = open_to_arm(unopened, site)
    unopened.evaluate(DRAW_NOTHING)
    button.dispatch_event("pointerdown", {"button": 0})
    refusals.reason = REASON
    expect(button).to_have_text("Not now: see below")
    refusals.reason = None
    expect(button).to_have_text("Release, then hold again")
    unopened.evaluate("drawOn()")
    assert not asks_to_arm(unopened)
    button.dispatch_event("pointerup")
    expect(button).to_have_text("Hold to arm")
