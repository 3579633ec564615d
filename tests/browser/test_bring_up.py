"""The bring-up on the page, all of it, with mistakes that are found, named and mended on the way."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Page, expect

from robot_runtime.experiments.bring_up.guide import STEPS
from tests.browser.bringing_up import PagePerson, wait_for_the_robot
from tests.stack import Stack

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


@pytest.mark.timeout(240)
def test_a_robot_is_brought_up_step_by_step(person: PagePerson, page: Page, stack: Stack) -> None:
    for step in STEPS:
        if step.name in FOUND:
            mistake, words = FOUND[step.name]
            person.spoil(mistake)
            person.do(step.name)
            assert person.state(step.name) == "wrong"
            assert words in person.advice()
            person.mend()
        person.do(step.name)
        assert person.state(step.name) == "done", person.advice()
    person.end()
    report = stack.api.get("/bring-up/report").text
    assert "Nothing was found wrong." in report
    assert "The calibration is whole." in report
    expect(page.get_by_role("link", name="Report of the last bring-up")).to_be_visible()
