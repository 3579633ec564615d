"""The craft's view: sessions to fit and to check; tests/server/features/identification fits them."""

import re
from typing import Any

from playwright.sync_api import Page, Route, expect

from tests.browser.pages import SESSIONS, fill
from tests.browser.site import Site


def test_sessions_that_show_nothing_are_refused_in_words(page: Page, site: Site) -> None:
    fill(site)
    page.goto(f"{site.url}/#/tune/craft")
    fit = page.get_by_role("button", name="Fit the craft")
    expect(fit).to_be_disabled()
    expect(page.get_by_role("region", name="Craft in use")).to_contain_text("Default craft")
    first, second = (page.get_by_role("row", name=re.compile(name)).first for name in SESSIONS)
    first.get_by_role("checkbox").check()
    # A session is fitted or checks, never both.
    first.get_by_role("radio").check()
    expect(first.get_by_role("checkbox")).not_to_be_checked()
    expect(fit).to_be_disabled()
    second.get_by_role("checkbox").check()
    fit.click()
    expect(page.get_by_role("alert").filter(has_text="The last fit has no result")).to_contain_text(
        "No part of these sessions can be used: it takes depth, IMU and fins without a gap for 8 s",
    )
    width = page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
    assert width == 0


def fitted(run: int) -> dict[str, Any]:
    """Return the state after the fit of this number, whose craft predicts worse than the one before."""
    check = {"id": 2, "name": "Dive", "before_error": 0.1, "after_error": 0.125, "improvement": 0.8}
    result = {
        "sessions": [],
        "numbers": [],
        "noise": {},
        "check": check | {"times": [], "channels": []},
        "missing": [],
        "affected": [f"The effect of fit {run}."],
        "craft": "",
    }
    craft = {"title": "", "origin": "", "file": "", "can_undo": False, "problem": ""}
    last = {"run": f"{run:016x}", "sessions": [1], "left_out": 2, "problem": "", "result": result}
    return {"active": None, "last": last, "craft": craft}


def test_the_craft_of_a_second_fit_can_be_adopted(page: Page, site: Site) -> None:
    fill(site)
    run = 1

    def answer(route: Route) -> None:
        nonlocal run
        if route.request.method == "GET":
            route.fulfill(json=fitted(run))
        elif route.request.url.endswith(f"/adopt?run={run:016x}"):
            route.fulfill(json={"affected": ["It has another mass."]})
        else:
            run = 2
            route.fulfill(status=201, json={"run": f"{run:016x}"})

    page.route(re.compile("/api/identification"), answer)
    page.goto(f"{site.url}/#/tune/craft")
    expect(page.get_by_text("Dive is predicted 1.3 times worse than before.")).to_be_visible()
    adopt = page.get_by_role("button", name="Adopt this craft")
    adopt.click()
    expect(page.get_by_text("It has another mass.")).to_be_visible()
    expect(adopt).to_have_count(0)
    page.get_by_role("row", name=re.compile(SESSIONS[0])).first.get_by_role("checkbox").check()
    page.get_by_role("button", name="Fit the craft").click()
    expect(page.get_by_text("The effect of fit 2.")).to_be_visible()
    expect(adopt).to_be_enabled()
    expect(page.get_by_text("It has another mass.")).to_have_count(0)


def test_sessions_that_could_not_be_listed_are_asked_for_again(page: Page, site: Site) -> None:
    fill(site)
    listing = re.compile("/api/sessions")
    page.route(listing, lambda route: route.abort())
    page.goto(f"{site.url}/#/tune/craft")
    again = page.get_by_role("button", name="Try again")
    expect(again).to_be_visible()
    page.unroute(listing)
    again.click()
    expect(page.get_by_role("button", name="Fit the craft")).to_be_visible()
    expect(again).to_have_count(0)
