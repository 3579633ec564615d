"""Arms and drives the robot on the page, for all browser tests."""

from playwright.sync_api import Page, expect

DIVE_MS = 30_000


def wait_for_depth(page: Page, low: float, high: float) -> None:
    """Waits until the shown depth (m) lies between `low` and `high`."""
    page.wait_for_function(
        """([low, high]) => {
            const readings = [...document.querySelectorAll('.reading')];
            const shown = readings.find((one) => one.textContent.includes('Depth'));
            const depth = Number(shown?.querySelector('.value')?.textContent.replace('\u2212', '-'));
            return depth >= low && depth <= high;
        }""",
        arg=[low, high],
        timeout=DIVE_MS,
    )


def hold_to_arm(page: Page) -> None:
    """Holds the button until the robot is armed."""
    button = page.get_by_role("button", name="Hold to arm")
    expect(button).to_be_enabled()
    button.hover()
    page.mouse.down()
    expect(page.get_by_text("The fins may move")).to_be_visible()
    page.mouse.up()


def arm_by_hand(page: Page) -> None:
    """Chooses manual and arms."""
    page.get_by_role("button", name="Manual", exact=True).click()
    hold_to_arm(page)
    expect(page.get_by_role("region", name="Drive")).to_be_visible()


def expect_surge(page: Page, words: str) -> None:
    """Expects these words for the surge of the navigation command."""
    command = page.get_by_role("region", name="Navigation command")
    expect(command.locator(".word").first).to_have_text(words)
