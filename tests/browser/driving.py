"""Arms and drives the robot on the page, for all browser tests."""

import re
import time

from playwright.sync_api import Locator, Page, expect

HOLD_SECONDS = 40
REFUSED = (409, 503, 504)
"""Something speaks against it; the runtime does not answer in time."""


def wait_for_depth(page: Page, low: float, high: float) -> None:
    """Wait until the shown depth (m) lies between `low` and `high`."""
    page.wait_for_function(
        """([low, high]) => {
            const readings = [...document.querySelectorAll('.reading')];
            const shown = readings.find((one) => one.textContent.includes('Depth'));
            const depth = Number(shown?.querySelector('.value')?.textContent.replace('\u2212', '-'));
            return depth >= low && depth <= high;
        }""",
        arg=[low, high],
    )


def hold_to_arm(page: Page, armed: Locator | None = None) -> None:
    """Hold the button until the robot is armed, which `armed` shows, or the usual words.

    On a busy computer a board may be late at that moment, and the runtime refuses; or news may be, and the
    button does nothing. Then it is held again, as a person does.
    """
    button = page.get_by_role("button", name="Hold to arm")
    in_vain = page.get_by_role("button", name=re.compile("^Not now|^Release, then"))
    answers: list[int] = []
    page.on(
        "response",
        lambda response: answers.append(response.status) if response.url.endswith("/commands/arm") else None,
    )
    end = time.monotonic() + HOLD_SECONDS
    while not answers or answers[-1] in REFUSED:
        assert time.monotonic() < end, answers
        tries = len(answers)
        expect(button).to_be_enabled()
        button.hover()
        page.mouse.down()
        while len(answers) == tries and not in_vain.is_visible():
            assert time.monotonic() < end, answers
            page.wait_for_timeout(20)
        page.mouse.up()
    expect(armed or page.get_by_text("The fins may move")).to_be_visible()


def arm_by_hand(page: Page) -> None:
    """Choose manual and arm."""
    page.get_by_role("button", name="Manual", exact=True).click()
    hold_to_arm(page)
    expect(page.get_by_role("region", name="Drive")).to_be_visible()


def expect_surge(page: Page, message: str) -> None:
    """Expect these words for the surge of the navigation command."""
    command = page.get_by_role("region", name="Navigation command")
    expect(command.locator(".word").first).to_have_text(message)
