"""The bar of states: in no state, at no width does one thing in it lie over another or leave the window."""

import json
from typing import Any

from playwright.sync_api import Browser, Page, Route, WebSocketRoute, expect

from robot_runtime.contract.topics import BY_ID, BY_NAME
from robot_runtime.transport.blocks import HEADER, Block
from tests.browser.opening import DESKTOP
from tests.browser.people import somebody
from tests.pages.dive_site import DiveSite

ONE_ROW = 60
"""px: STOP and its margins."""
NARROWEST, WIDEST, STEP = 320, 2560, 20
BREAKS = (900, 1100, 1720, 2200)
"""Widths at which the page itself changes."""
ALARM = {
    "fault": "leak",
    "severity": "alarm",
    "since": 1.0,
    "until": None,
    "active": True,
    "acknowledged": False,
    "what": "Water in the hull.",
    "cause": "A seal leaks.",
    "remedy": "Take the robot out.",
    "consequences": [],
}
ARMED = {"armed": True, "armed_since": -36000.0}
SIMULATED = {"parts": [{"name": "simulator", "state": "healthy", "age": 0.1, "since": 1.0, "pid": 1}]}
STATES: dict[str, tuple[str, dict[str, Any]]] = {
    "disarmed": ("Disarmed", {}),
    "not ready": ("not ready", {"refusals": ["The depth sensor is silent."]}),
    "manual": ("MANUAL", {"mode": "manual"} | ARMED),
    "automatic": ("AUTO", {"mode": "automatic"} | ARMED),
    "failsafe": ("FAILSAFE", {"mode": "failsafe", "alarms": [ALARM]}),
    "no board": ("not ready", {"connected": False, "refusals": ["The board is not connected."]}),
}
"""Words in the bar, and what the robot's state then holds."""
FRAME = """([width, address]) => {
    const frame = document.createElement('iframe');
    frame.style = `border: 0; height: 800px; width: ${width}px`;
    frame.src = address;
    document.body.append(frame);
}"""
OVERLAPS = """async ([widths, breaks]) => {
    const frame = document.querySelector('iframe'), inner = frame.contentWindow, found = [], heights = {};
    const top = inner.document.querySelector('header.top');
    // What is below the bar would be laid out again at each width, too.
    inner.document.querySelector('.view').style.display = 'none';
    const dimmed = () => top.querySelectorAll('.dimmed').length;
    const faded = dimmed();
    let last = Infinity;
    for (const width of widths) {
        frame.style.width = `${width}px`;
        if (breaks.some((one) => last < one !== width < one)) {
            // The page hears of it in the next frame; meanwhile what it shows may have become old.
            // The pages' names leave a narrow bar once the page has heard.
            const deaf = () => dimmed() > faded || (width < breaks[0] && top.querySelector('.tab') !== null);
            for (let beat = 0; beat < 3 || (deaf() && beat < 300); beat += 1) {
                await new Promise(inner.requestAnimationFrame);
            }
        }
        last = width;
        heights[width] = top.offsetHeight;
        const named = '.program, .stop, .tab, .states > *, .row > *:not(.buttons), .buttons > *';
        const things = [...top.querySelectorAll(named)]
            .map((thing) => [thing, thing.getBoundingClientRect()])
            .filter(([, box]) => box.width > 1 && box.height > 1);
        for (const [thing, box] of things) {
            const leaves = box.left < -0.5 || box.right > width + 0.5;
            if (leaves) found.push(`${width}: ${thing.className} leaves the window`);
        }
        for (const [place, [one, a]] of things.entries()) {
            for (const [other, b] of things.slice(place + 1)) {
                if (Math.min(a.right, b.right) - Math.max(a.left, b.left) <= 0.5) continue;
                if (Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) <= 0.5) continue;
                if (one.contains(other) || other.contains(one)) continue;
                found.push(`${width}: ${one.textContent.trim()} | ${other.textContent.trim()}`);
            }
        }
    }
    return [top.querySelectorAll('.states').length, dimmed() - faded, found, heights];
}"""


class ChangedState:
    """Has the page read `state` in each state of the robot, and `health` in each health of its parts."""

    def __init__(self, page: Page) -> None:
        self.state: dict[str, Any] = {}
        self.health: dict[str, Any] = {}
        page.route_web_socket("**/api/live", self._hand_on)

    def _hand_on(self, socket: WebSocketRoute) -> None:
        def hand_on(message: str | bytes) -> None:
            socket.send(
                self._change_blocks(message) if isinstance(message, bytes) else self._change_report(message)
            )

        socket.connect_to_server().on_message(hand_on)

    def _change_report(self, message: str) -> str:
        report = json.loads(message)
        return json.dumps(report | self.health) if report.get("type") == "health" else message

    def _change_blocks(self, message: bytes) -> bytes:
        changed = b""
        while message:
            topic, _, count, first, size = HEADER.unpack_from(message)
            payload, message = message[HEADER.size : HEADER.size + size], message[HEADER.size + size :]
            if topic == BY_NAME["state"].id:
                payload = json.dumps([document | self.state for document in json.loads(payload)]).encode()
            changed += Block.of(BY_ID[topic], count, first, payload).data
        return changed


def without_framing_rules(route: Route) -> None:
    """Answer with a page that may stand in a frame: a script changes its width faster than a window's."""
    answer = route.fetch()
    remaining = {
        name: value
        for name, value in answer.headers.items()
        if name not in ("content-security-policy", "x-frame-options")
    }
    route.fulfill(response=answer, headers=remaining)


def in_a_frame(page: Page, site: DiveSite, address: str = "/#/people") -> ChangedState:
    """Show the site in a frame of the page, whose robot's state can be changed."""
    changed = ChangedState(page)
    changed.health = SIMULATED
    # To the browser a page that a test has answered is one from far away.
    page.context.grant_permissions(["local-network-access"], origin=site.url)
    page.route(f"{site.url}/", without_framing_rules)
    # A page cannot stand in a frame of itself.
    page.route(
        f"{site.url}/around", lambda route: route.fulfill(content_type="text/html", body="<body></body>")
    )
    page.goto(f"{site.url}/around")
    page.evaluate(FRAME, [NARROWEST, address])
    return changed


def heights_without_collision(page: Page, label: str, step: int = STEP) -> dict[str, int]:
    """Wait for these words in the bar, then look at widths `step` px apart and at those around each change.

    Return how high the bar is at each width.
    """
    frame = page.locator("iframe")
    frame.evaluate("(frame, width) => { frame.style.width = `${width}px`; }", NARROWEST)
    expect(page.frame_locator("iframe").locator(".top").get_by_text(label, exact=True)).to_be_visible()
    around = {width for edge in BREAKS for width in (edge - 1, edge)}
    widths = sorted({*range(NARROWEST, WIDEST + 1, step), *around, WIDEST})
    rows, old, collisions, heights = page.evaluate(OVERLAPS, [widths, BREAKS])
    assert rows == 1, "the frame did not become wide"
    assert old == 0, "what the bar shows became old"
    assert collisions == [], f"{label}: {len(collisions)} of them: {collisions[:6]}"
    return dict(heights)


def test_nothing_in_the_bar_collides_in_any_state_and_a_wide_one_keeps_its_height(
    page: Page, site: DiveSite
) -> None:
    changed = in_a_frame(page, site)
    # A recording makes the bar as full as it gets.
    session = site.api.post("/sessions", json={"name": "a wide bar"}).raise_for_status().json()["id"]
    expect(page.frame_locator("iframe").locator(".top .lamp.on")).to_be_visible()
    heights: list[dict[str, int]] = []
    for state, (label, fields) in STATES.items():
        changed.state = fields
        heights.append(heights_without_collision(page, label, 1 if state == "automatic" else STEP))
    site.api.post(f"/sessions/{session}/stop").raise_for_status()
    for width in (width for width in heights[0] if int(width) >= BREAKS[0]):
        assert len({bar[width] for bar in heights}) == 1, (
            f"{width}: {[bar[width] for bar in heights]} px high"
        )


def test_nothing_in_the_bar_collides_in_a_replay(page: Page, site: DiveSite) -> None:
    changed = in_a_frame(page, site, "/#/replay/1")
    changed.state = STATES["manual"][1]
    heights_without_collision(page, "ARMED")


def test_the_bar_of_the_flight_view_is_one_row_on_a_desktop(page: Page, site: DiveSite) -> None:
    changed = in_a_frame(page, site, "/#/flight")
    changed.state = STATES["manual"][1]
    session = site.api.post("/sessions", json={"name": "a wide bar"}).raise_for_status().json()["id"]
    expect(page.frame_locator("iframe").locator(".top .lamp.on")).to_be_visible()
    heights = heights_without_collision(page, "MANUAL")
    site.api.post(f"/sessions/{session}/stop").raise_for_status()
    assert {high for width, high in heights.items() if int(width) >= DESKTOP["width"]} == {ONE_ROW}


def test_nothing_in_the_bar_collides_for_who_looks_on(browser: Browser, site: DiveSite) -> None:
    with somebody(browser, site, "viewer") as page:
        in_a_frame(page, site)
        heights_without_collision(page, "Disarmed")
