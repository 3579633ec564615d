"""The form of a communication test: each error of the server is shown at its field."""

import json
import re
from pathlib import Path

from playwright.sync_api import Page, expect

from tests.browser.code import write_code
from tests.pages.dive_site import DiveSite

FIGURE_10 = Path("firmware/examples/comm_test/figure10.json")


def test_a_problem_of_a_field_is_at_the_field(page: Page) -> None:
    open_form(page)
    page.get_by_label(re.compile("^Pi delays")).fill("0, -1")
    expect(page.get_by_label(re.compile("^Pi delays"))).to_have_attribute("aria-invalid", "true")
    expect(page.get_by_text("Entry 2 is -1; it must lie between 0 and 10")).to_be_visible()
    expect(page.get_by_text("This test cannot run: one problem, shown above.")).to_be_visible()


def test_a_problem_of_the_whole_document_is_above_its_announcement(page: Page) -> None:
    open_form(page)
    delays = ", ".join(f"{number / 1000:g}" for number in range(101))
    page.get_by_label(re.compile("^Pi delays")).fill(delays)
    announced = page.get_by_text("This test cannot run: one problem, shown above.")
    expect(announced).to_be_visible()
    problem = page.get_by_text("at most 500 can be run at once")
    expect(problem).to_be_visible()
    above, below = problem.bounding_box(), announced.bounding_box()
    assert above is not None
    assert below is not None
    assert above["y"] + above["height"] <= below["y"]


def test_the_choice_of_tests_counts_the_problems_of_each(page: Page) -> None:
    open_form(page)
    (test,) = json.loads(FIGURE_10.read_text(encoding="utf-8"))
    page.get_by_role("button", name="JSON", exact=True).click()
    write_code(
        page.get_by_role("textbox", name="The document as JSON"),
        json.dumps([test, test | {"delay": [-1], "expected": 0}]),
    )
    page.get_by_role("button", name="Edit", exact=True).click()
    options = page.get_by_label("Test of the document").locator("option")
    expect(options).to_have_text([re.compile(r"^Test 1 of 2: [^(]*$"), re.compile(r"\(2 problems\)$")])


def test_faults_stay_open_and_their_seed_stays_while_a_fault_is_written_anew(page: Page) -> None:
    open_form(page)
    faults = page.locator("details", has_text="Faults on the line")
    faults.locator("summary").click()
    seed, dropped = (
        faults.get_by_label(re.compile("^Seed")),
        faults.get_by_label(re.compile("^Dropped bytes")),
    )
    seed.fill("5")
    seed.blur()
    expect(seed).to_have_value("5")
    dropped.fill("0.01")
    dropped.fill("")
    expect(dropped).to_be_visible()
    expect(seed).to_have_value("5")


def test_ones_own_document_stays_in_the_list_while_another_page_is_looked_at(page: Page) -> None:
    open_form(page)
    page.get_by_label(re.compile("^Pi delays")).fill("0.125")
    own = page.get_by_role("radio", name="Your own")
    expect(own).to_be_checked()
    page.get_by_role("radio").first.check()
    page.get_by_role("link", name="Sessions", exact=True).click()
    expect(page.get_by_role("heading", name="Sessions", exact=True)).to_be_visible()
    open_form(page)
    own.check()
    expect(page.get_by_label(re.compile("^Pi delays"))).to_have_value("0.125")


def test_a_run_that_the_address_names_twice_is_compared_once(page: Page, site: DiveSite) -> None:
    page.goto(f"{site.url}/#/comm-tests/compare/table6/table6")
    expect(page.get_by_role("heading", name="Compare runs")).to_be_visible()


def open_form(page: Page) -> None:
    page.get_by_role("link", name="Comm tests").click()
    page.get_by_role("button", name="Edit", exact=True).click()
