"""The first dive as a person walks it: only what the card says and outlines is pressed."""

import re

import pytest
from playwright.sync_api import Browser, ElementHandle, Page, StorageState, expect

from tests.browser.axe import AXE, faults_in_both_themes
from tests.browser.chromium import GUIDE
from tests.browser.driving import HOLD_SECONDS
from tests.browser.opening import DESKTOP, opened_page
from tests.stack import Stack

STEPS = 10


class Walker:
    """Presses what the card outlines, until it ticks the step."""

    def __init__(self, page: Page) -> None:
        self._page = page
        self.card = page.get_by_role("region", name="First dive")

    def walk(self, number: int) -> None:
        """Do the step of this number, from 1 on."""
        count = f"{number} of {STEPS}"
        expect(self.card).to_contain_text(count)
        keys = self.card.locator("strong", has_text=re.compile(r"^[A-Z]$"))
        if keys.count():
            self._page.keyboard.press(keys.inner_text().lower())
            expect(self.card).not_to_contain_text(count)
        else:
            while (way := self._next(count)) != "ticked":
                self._press(way)

    def _next(self, count: str) -> str:
        """Return how to press what is outlined now and has not been pressed yet: "hold", "click", or the
        option of a list that the card names; "ticked" once the step is.

        Card and control are looked at in one moment: the step may be ticked in the next.
        """
        way = self._page.wait_for_function(
            """count => {
                const card = document.querySelector('section[aria-label="First dive"]');
                if (!card.textContent.includes(count)) return 'ticked';
                const control = document.querySelector('[data-guided]');
                if (!control || control === window.pressed || control.ariaDisabled === 'true') return null;
                const named = [...card.querySelectorAll('strong')].map(name => name.textContent);
                const options = [...control.options ?? []].map(option => option.text);
                const way = control.localName === 'select' ? options.find(option => named.includes(option))
                    : control.classList.contains('hold') ? 'hold' : 'click';
                if (way) window.pressed = control;
                return way;
            }""",
            arg=count,
        )
        return str(way.json_value())

    def _press(self, way: str) -> None:
        control = self._page.evaluate_handle("window.pressed").as_element()
        assert control is not None
        if way == "click":
            control.click()
        elif way == "hold":
            self._hold(control)
        else:
            control.select_option(label=way)

    def _hold(self, control: ElementHandle) -> None:
        """Hold it until it is answered. Where the robot refuses, it is held again, as a person does."""
        with self._page.expect_response(re.compile("/(arm|start)$"), timeout=1000 * HOLD_SECONDS) as answered:
            control.hover()
            self._page.mouse.down()
        self._page.mouse.up()
        if not answered.value.ok:
            self._page.evaluate("window.pressed = null")


@pytest.mark.usefixtures("_at_rest")
def test_the_first_dive_is_walked_as_its_card_says(
    browser: Browser, stack: Stack, cookies: StorageState
) -> None:
    (before,) = (loop for loop in stack.api.get("/robot").json()["loops"] if loop["name"] == "depth")
    with opened_page(browser, stack, cookies, DESKTOP) as page:
        page.evaluate(f"localStorage.removeItem('{GUIDE}')")
        page.reload()
        walker = Walker(page)
        expect(walker.card).to_be_visible()
        page.evaluate(AXE.read_text())
        assert faults_in_both_themes(page) == []
        for number in range(1, STEPS + 1):
            walker.walk(number)
        expect(walker.card).to_contain_text("You have dived")
        walker.card.get_by_role("button", name="Close").click()
        page.reload()
        expect(page.get_by_role("link", name="Operate")).to_be_visible()
        expect(walker.card).to_have_count(0)
    # The mission goes on, and refuses another controller.
    stack.calm()
    stack.api.post("/control/take?over=true").raise_for_status()
    stack.api.post(
        "/robot/commands/loop", json={"name": "depth", "controller": before["controller"]}
    ).raise_for_status()
    stack.api.post("/control/release").raise_for_status()
