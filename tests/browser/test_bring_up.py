"""The bring-up on the page, all of it, with mistakes that are found, named and mended on the way."""

from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import Page, expect

from robot_runtime.experiments.bring_up.guide import STEPS
from robot_runtime.simulation.boards.emulator_process import EmulatorClient
from tests.browser.axe import AXE, faults
from tests.browser.bringing_up import PagePerson, wait_for_the_robot
from tests.browser.opening import DESKTOP, PHONE
from tests.stack import Stack
from tests.waiting import wait_for

FOUND = {
    "devices": ("strap-wrong:back-right", "A bridge answers at 0x62 instead"),
    "fin_2": ("encoders-swapped:front-right,back-left", "select lines of the back left and the front right"),
    "motor_0": (
        "motors-swapped:front-right,back-left",
        "motors of the front right and the back left fin are",
    ),
}
"""A mistake for some of the steps, and what the page says of it."""


@pytest.fixture
def person(page: Page, stack: Stack) -> Iterator[PagePerson]:
    """Somebody with a bring-up, which ends with the test: the robot is back then."""
    person = PagePerson(page, stack)
    person.begin()
    yield person
    wait_for_the_robot(stack)


def test_a_robot_is_brought_up_step_by_step(person: PagePerson, page: Page) -> None:
    for step in STEPS:
        if step.name in FOUND:
            mistake, text = FOUND[step.name]
            person.spoil(mistake)
            person.do(step.name)
            assert person.state(step.name) == "wrong"
            assert text in person.advice()
            person.mend()
        person.do(step.name)
        assert person.state(step.name) == "done", person.advice()
    report = person.report()
    assert "Nothing was found wrong." in report
    assert "The calibration is whole." in report
    expect(page.get_by_role("link", name="Report of the last bring-up")).to_be_visible()


RELEASES: dict[str, Callable[[Page, Stack], object]] = {
    "Escape": lambda page, _: page.keyboard.press("Escape"),
    "STOP of somebody else": lambda _, stack: stack.api.post("/robot/stop").raise_for_status(),
    "another window": lambda page, _: page.evaluate("window.dispatchEvent(new Event('blur'))"),
    "a hidden page": lambda page, _: page.evaluate(
        """() => {
            Object.defineProperty(document, 'hidden', { value: true, configurable: true });
            document.dispatchEvent(new Event('visibilitychange'));
            delete document.hidden;
        }"""
    ),
}
"""Ways in which a held button is released while the pointer stays down on it."""


def test_a_held_motor_is_released_a_step_skipped_and_a_step_accessible(
    person: PagePerson, page: Page, stack: Stack
) -> None:
    expect(page.get_by_text("The robot’s board is at other work")).to_be_visible()
    expect(page.get_by_text("The runtime does not answer")).to_have_count(0)
    person.skip("battery")
    page.reload()
    expect(page.get_by_role("link", name="Battery")).to_have_text("Battery skipped")

    person.open("motor_1")
    with EmulatorClient(stack.data / "run/board.sock") as board:
        for how, release in RELEASES.items():
            person.hold_button().hover()
            page.mouse.down()
            wait_for(lambda: abs(board.fins().speeds[1]) > 1, f"the motor, to be stopped by {how}")
            with page.expect_response("**/api/bring-up/actions"):
                release(page, stack)
            expect(page.get_by_role("button", name="Hold to turn it")).to_be_visible()
            wait_for(lambda: abs(board.fins().speeds[1]) < 0.05, f"rest after {how}")
            page.mouse.up()

    page.evaluate(AXE.read_text())
    person.do("devices")
    for step in ("devices", "pressure", "fin_0", "motor_1"):
        person.open(step)
        for size in (DESKTOP, PHONE):
            page.set_viewport_size(size)
            assert faults(page) == [], (step, size)
            wide = page.evaluate("document.documentElement.scrollWidth - innerWidth")
            assert wide <= 0, (step, size)
        page.set_viewport_size(DESKTOP)
    assert "Skipped: Battery." in person.report()
