"""Set points and parameters as people type them: what is refused changes nothing."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.stack import Stack

SET_POINT = "control.set_point"
REFUSED = ("1,234", "1,2,3", "60 cm", "six", "0x1", "−0.3", "60", "1.234,5")


@pytest.fixture
def page(browser: Browser, cookies: object, stack: Stack) -> Iterator[Page]:
    """A page in a browser whose language has decimal commas."""
    context = browser.new_context(locale="de-DE", storage_state=cookies)  # type: ignore[arg-type]
    yield context.new_page()
    context.close()
    stack.api.post("/robot/commands/parameters", json={"values": {SET_POINT: 0.5}}).raise_for_status()


def set_point(stack: Stack) -> object:
    listed = stack.api.get("/parameters").raise_for_status().json()["parameters"]
    return next(parameter["value"] for parameter in listed if parameter["name"] == SET_POINT)


def test_a_set_point_is_what_was_typed_or_stays_what_it_was(page: Page, stack: Stack) -> None:
    page.goto(f"{stack.url}/#/operate")
    panel = page.get_by_role("region", name="Set points")
    field = panel.get_by_role("spinbutton", name="default")
    apply = panel.get_by_role("button", name="Apply")
    for typed, value in (("0,6", 0.6), ("1.25 m", 1.25), ("0,7 m", 0.7)):
        field.fill("")
        field.press_sequentially(typed)
        expect(field).to_have_value(typed)
        expect(field).to_have_attribute("aria-invalid", "false")
        with page.expect_response("**/robot/commands/*"):
            apply.click()
        expect(field).to_have_value(f"{value:g}")
        expect(apply).to_be_disabled()
        assert set_point(stack) == value
    for typed in REFUSED:
        field.fill("")
        field.press_sequentially(typed)
        expect(field).to_have_value(typed)
        expect(field).to_have_attribute("aria-invalid", "true")
        expect(apply).to_be_disabled()
        expect(apply).to_have_accessible_description("Correct the marked numbers first.")
    panel.get_by_role("button", name="Discard").click()
    expect(field).to_have_value("0.7")
    assert set_point(stack) == 0.7


def test_a_parameter_steps_by_arrow_keys_and_reads_a_comma(page: Page, stack: Stack) -> None:
    page.goto(f"{stack.url}/#/tune/parameters")
    page.get_by_label("Find parameters").fill(SET_POINT)
    field = page.get_by_label(SET_POINT, exact=True)
    field.fill("1,5")
    expect(field).to_have_value("1,5")
    field.press("ArrowUp")
    expect(field).to_have_value("2.5")
    field.press("Enter")
    expect(page.get_by_role("button", name="Apply 1 change")).to_have_count(0)
    assert set_point(stack) == 2.5
    field.fill("1,234")
    field.press("Enter")
    expect(field).to_have_value("1,234")
    expect(page.get_by_role("button", name="Apply 1 change")).to_be_disabled()
    assert set_point(stack) == 2.5
