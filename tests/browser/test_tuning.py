"""Tuning: a stored step response overlaid with others, and gains from a relay."""

import re
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser.driving import hold_to_arm
from tests.browser.people import somebody
from tests.stack import Stack
from tests.waiting import wait_for


def arm(page: Page) -> None:
    hold_to_arm(page, page.get_by_role("button", name="Run the step", disabled=False))


def fill(page: Page, **values: str) -> None:
    for label, value in values.items():
        page.get_by_label(label.replace("_", " "), exact=True).fill(value)


@pytest.fixture
def empty(stack: Stack) -> Stack:
    """A robot without stored runs."""
    for run in stack.api.get("/tuning/runs").json()["runs"]:
        stack.api.delete(f"/tuning/runs/{run['id']}").raise_for_status()
    return stack


def test_a_step_is_run_and_stored(empty: Stack, any_page: Page) -> None:
    page = any_page
    page.goto(f"{empty.url}/#/tune/bench")
    expect(page.get_by_text("No run yet")).to_be_visible()
    page.get_by_text("Limits and waiting").click()
    fill(page, Start="0.2", Target="0.4", Duration="3", Longest_wait="1")
    arm(page)
    page.get_by_role("button", name="Run the step").click()
    expect(page.get_by_role("progressbar", name="Progress")).to_be_visible()
    figures = page.get_by_role("region", name="Figures of the step responses")
    expect(figures).to_be_visible()
    expect(figures.get_by_role("row", name=re.compile("^Effort"))).to_contain_text(re.compile(r"\d\.\d"))
    page.get_by_role("button", name="STOP").click()

    page.reload()
    runs = page.get_by_role("region", name="Runs", exact=True)
    expect(runs.get_by_text("Bang-bang, output 1")).to_be_visible()
    expect(figures).to_be_visible()
    runs.get_by_role("button", name=re.compile("^Rename")).click()
    runs.get_by_label("Name of the run").fill("in tap water")
    runs.get_by_role("button", name="Save").click()
    expect(figures.get_by_role("columnheader", name=re.compile("in tap water$"))).to_be_visible()
    runs.get_by_role("button", name=re.compile("^Delete .* in tap water$")).click()
    runs.get_by_role("button", name="Delete permanently").click()
    expect(page.get_by_text("No run yet")).to_be_visible()


@pytest.fixture
def depth(stack: Stack) -> Iterator[dict[str, Any]]:
    """The depth loop; restored once the page has been closed."""
    loop: dict[str, Any] = stack.api.get("/robot").json()["loops"][0]
    yield loop
    pid = next(controller for controller in loop["controllers"] if controller["name"] == "pid")
    gains = {gain["name"]: gain["value"] for gain in pid["gains"]}
    for change in ({"controller": "pid", "gains": gains}, {"controller": loop["controller"]}):
        stack.api.post("/robot/commands/loop", json={"name": "depth", **change}).raise_for_status()


def test_a_relay_gives_gains_that_a_step_tries_and_back_returns_from(
    depth: dict[str, Any], empty: Stack, page: Page, browser: Browser
) -> None:
    page.goto(f"{empty.url}/#/tune/bench")
    page.get_by_text("Relay", exact=True).click()
    fill(page, **{"Centre": "0.3", "Command_±": "100", "Cycles": "3"})
    arm(page)
    page.get_by_role("button", name="Run the relay").click()
    table = page.get_by_role("table", name="Gains by rule, beside the present ones")
    expect(table).to_be_visible()
    assert empty.api.get("/robot").json()["loops"][0] == depth

    with somebody(browser, empty, "viewer") as other:
        other.goto(f"{empty.url}/#/tune/bench")
        other.get_by_role("button", name="Set the sliders to the gains by Tyreus–Luyben").click()
        expect(other.get_by_role("button", name="Keep")).to_be_disabled()
        expect(other.get_by_role("button", name=re.compile("^Delete"))).to_be_disabled()

    table.get_by_role("button", name="Set the sliders to the gains by Tyreus–Luyben").click()
    page.get_by_role("button", name="Run the step").click()
    expect(page.get_by_text("Step response on depth")).to_be_visible()
    assert empty.api.get("/robot").json()["loops"][0]["controller"] == "pid"
    page.get_by_role("button", name="STOP").click()
    expect(page.get_by_role("region", name="Runs", exact=True)).to_contain_text("The robot was disarmed.")
    page.get_by_role("button", name="Back", exact=True).click()
    expect(page.get_by_text("The gains of before are in force.")).to_be_visible()
    wait_for(lambda: empty.api.get("/robot").json()["loops"][0] == depth, "the gains of before")
