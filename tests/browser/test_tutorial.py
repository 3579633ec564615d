"""The tutorial as a person walks it: the names that it prints in bold are pressed, in its order."""

import re
from collections.abc import Callable
from typing import Literal

from playwright.sync_api import Locator, Page, expect

from tests.browser.driving import hold_to_arm, wait_for_depth
from tests.documents.blocks import DOCS
from tests.stack import Stack

TUTORIAL = (DOCS / "use/tutorial.md").read_text(encoding="utf-8")


def names_of(*steps: int) -> list[str]:
    """Return the names in bold of these steps, in their order."""
    chapters = re.split(r"^## (\d+)\. ", TUTORIAL, flags=re.MULTILINE)
    texts = dict(zip(map(int, chapters[1::2]), chapters[2::2], strict=True))
    return [name for step in steps for name in re.findall(r"\*\*(.+?)\*\*", texts[step])]


class Walker:
    """Presses what has a name; a panel that was named is where the next one is looked for first."""

    def __init__(self, page: Page) -> None:
        self._page = page
        self._panel: Locator | None = None

    def press(self, name: str) -> None:
        """Press a key, the arming button, a button, or a choice of a list; look at a panel."""
        panels = self._page.get_by_role("region", name=name, exact=True)
        if len(name) == 1:
            self._page.keyboard.press(name.lower())
        elif name == "Hold to arm":
            hold_to_arm(self._page)
        elif panels.count():
            self._panel = panels
        elif (button := self._locate("button", name)) is not None:
            button.click()
        else:
            choice = self._locate("option", name)
            assert choice is not None, f"the page has no {name}"
            choice.locator("xpath=..").select_option(choice.get_attribute("value"))

    def _locate(self, role: Literal["button", "option"], name: str) -> Locator | None:
        for position in (self._panel, self._page):
            if (
                position is not None
                and (element := position.get_by_role(role, name=name, exact=True)).count()
            ):
                return element
        return None


def test_the_tutorial_is_walked_word_by_word(page: Page, stack: Stack) -> None:
    def controller() -> str:
        (depth,) = (loop for loop in stack.api.get("/robot").json()["loops"] if loop["name"] == "depth")
        return str(depth["controller"])

    def in_force(title: str) -> None:
        panel = page.get_by_role("region", name="Depth controller")
        expect(panel.get_by_role("option", name=f"{title} (in use)")).to_have_count(1)

    before = controller()
    applied = iter(("PID", "Model-based"))
    effects: dict[str, Callable[[], None]] = {
        "Hold to arm": lambda: wait_for_depth(page, 0.4, 0.6),
        "yellow": lambda: expect(page.get_by_text("set point 1.00 m", exact=True)).to_be_visible(),
        "no card": lambda: expect(page.get_by_text("set point 0.50 m", exact=True)).to_be_visible(),
        "Apply": lambda: in_force(next(applied)),
        "M": lambda: expect(page.get_by_text(re.compile("^Marked")).first).to_be_visible(),
        "STOP": lambda: expect(page.get_by_text("Disarmed", exact=True)).to_be_visible(),
    }
    pressed = names_of(2, 3, 4, 5, 6)
    walker = Walker(page)
    for name in pressed:
        walker.press(name)
        effects.get(name, lambda: None)()
    assert effects.keys() <= {*pressed}
    assert next(applied, None) is None
    stack.api.post("/control/take?over=true").raise_for_status()
    stack.api.post("/robot/commands/loop", json={"name": "depth", "controller": before}).raise_for_status()
    stack.api.post("/control/release").raise_for_status()
