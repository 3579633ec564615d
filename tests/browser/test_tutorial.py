"""The first dive as a person walks it: only what the card says and outlines is pressed."""

import re

import pytest
from playwright.sync_api import Browser, Locator, Page, StorageState, expect

from tests.browser.axe import AXE, faults_in_both_themes
from tests.browser.chromium import GUIDE
from tests.browser.driving import HOLD_SECONDS
from tests.browser.opening import DESKTOP, opened_page
from tests.stack import Stack

STEPS = 10
OUTLINED = "[data-guided]"


class Walker:
    """Presses what the card outlines, until it ticks the step."""

    def __init__(self, page: Page) -> None:
        self._page = page
        self.card = page.get_by_role("region", name="First dive")

    def walk(self, number: int) -> None:
        """Do the step of this number, from 1 on."""
        expect(self.card).to_contain_text(f"{number} of {STEPS}")
        keys = self.card.locator("strong", has_text=re.compile(r"^[A-Z]$"))
        if keys.count():
            self._page.keyboard.press(keys.inner_text().lower())
            self._page.evaluate(f"window.pressed = document.querySelector('{OUTLINED}')")
        while (control := self._next(number)) is not None:
            self._press(control)

    def _next(self, number: int) -> Locator | None:
        """Return what is outlined now and has not been pressed yet; None once the step is ticked."""
        self._page.wait_for_function(
            """([outlined, count]) => {
                const control = document.querySelector(outlined);
                const card = document.querySelector('section[aria-label="First dive"]');
                if (!card.textContent.includes(count)) return true;
                return control && control !== window.pressed && !control.ariaDisabled?.includes('true');
            }""",
            arg=[OUTLINED, f"{number} of {STEPS}"],
        )
        ticked = f"{number} of {STEPS}" not in self.card.inner_text()
        return None if ticked else self._page.locator(OUTLINED)

    def _press(self, control: Locator) -> None:
        control.evaluate("control => { window.pressed = control }")
        if control.evaluate("control => control.localName") == "select":
            (choice,) = [
                name
                for name in self.card.locator("strong").all_inner_texts()
                if control.locator("option", has_text=re.compile(f"^{name}$")).count()
            ]
            control.select_option(choice)
        elif control.inner_text().startswith("Hold to"):
            self._hold(control)
        else:
            control.click()

    def _hold(self, control: Locator) -> None:
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
