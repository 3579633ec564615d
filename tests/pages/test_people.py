"""People: links, roles, revocation."""

import csv
import re
from collections.abc import Iterator

import httpx
import pytest
from playwright.sync_api import Browser, Page, Route, ViewportSize, expect

from robot_runtime.clock import SimulatedClock
from server.http.sign_in.confirmation import CONFIRMED_SECONDS
from tests.browser.opening import DESKTOP, PHONE
from tests.browser.people import follow, make_link, somebody
from tests.browser.site import Site
from tests.pages.dive_site import DiveSite
from tests.waiting import SECONDS


@pytest.fixture
def fresh(browser: Browser, site: Site) -> Iterator[Page]:
    """The page of an operator who has just signed in, and so needs no confirmation."""
    with somebody(browser, site, "operator") as page:
        yield page


def test_a_link_signs_in_and_is_removed_from_the_address(browser: Browser, site: Site) -> None:
    link = make_link(site, "viewer")
    with browser.new_context() as context:
        page = context.new_page()
        page.goto("about:blank")
        follow(page, link, "Ana’s tablet")
        expect(page.get_by_role("button", name="STOP")).to_be_visible()
        assert "pair" not in page.url
        assert "Ana’s tablet" in [device["name"] for device in site.api.get("/access/devices").json()]
        page.go_back()
        page.go_forward()
        assert "pair" not in page.url


def test_a_code_can_be_typed(browser: Browser, site: Site) -> None:
    code = make_link(site, "viewer").partition("#pair=")[2]
    with browser.new_context() as context:
        page = context.new_page()
        page.goto(site.url)
        page.get_by_label("Pairing code").fill("nonsense")
        page.get_by_role("button", name="Sign in").click()
        expect(page.get_by_role("alert")).to_contain_text("code")
        page.get_by_label("Pairing code").fill(code)
        page.get_by_label("Name of this browser").fill("lab tablet")
        page.get_by_role("button", name="Sign in").click()
        page.goto(f"{site.url}/#/people")
        expect(page.get_by_role("region", name="You")).to_contain_text("lab tablet, viewer")
        page.get_by_role("button", name="Sign out").click()
        expect(page.get_by_role("alert").filter(has_text="You have signed out.")).to_be_visible()


def test_an_operator_pairs_promotes_and_revokes(fresh: Page, browser: Browser, site: Site) -> None:
    page = fresh
    page.goto(f"{site.url}/#/people")
    page.get_by_role("region", name="Invite").get_by_role("button", name="Create link").click()
    # No other device reaches this server, so that a picture for its camera would lead nowhere.
    expect(page.get_by_text("Only browsers on this computer reach the robot.")).to_be_visible()
    expect(page.get_by_alt_text("QR code of the link")).to_be_hidden()
    link = page.get_by_label("Link", exact=True).input_value()
    with browser.new_context(user_agent="Mozilla/5.0 (iPhone) Safari/604.1") as context:
        guest = context.new_page()
        follow(guest, link)
        expect(guest.get_by_role("button", name="STOP")).to_be_visible()
        guest.goto(f"{site.url}/#/people")
        you = guest.get_by_role("region", name="You")
        expect(you).to_contain_text("viewer")

        page.get_by_role("button", name="Rename Safari on iPhone").click()
        page.get_by_role("table").get_by_label("Name", exact=True).fill("guest")
        page.get_by_role("button", name="Save").click()
        with guest.expect_websocket() as coming:
            page.get_by_role("button", name="Make operator: guest").click()
        expect(you).to_contain_text("guest, operator")
        # Only a live socket can receive the reason of its closing.
        coming.value.wait_for_event("framereceived")

        page.get_by_role("button", name="Revoke guest").click()
        page.get_by_role("button", name="Revoke", exact=True).click()
        expect(guest.get_by_role("heading", name="Sign in to turtle")).to_be_visible()
        expect(guest.get_by_role("alert").filter(has_text="revoked")).to_be_visible()
        expect(page.get_by_role("row", name=re.compile("guest"))).to_be_hidden()


def test_an_invitation_has_a_picture_and_links_for_every_address(fresh: Page, site: Site) -> None:
    def reach_from_elsewhere(route: Route) -> None:
        answer = route.fetch().json()
        others = [answer["link"].replace("localhost", "192.168.0.7").replace("127.0.0.1", "192.168.0.7")]
        route.fulfill(json=answer | {"only_here": False, "other_links": others}, status=201)

    fresh.route("**/api/access/codes", reach_from_elsewhere)
    fresh.goto(f"{site.url}/#/people")
    fresh.get_by_role("region", name="Invite").get_by_role("button", name="Create link").click()
    picture = fresh.get_by_alt_text("QR code of the link")
    expect(picture).to_have_js_property("complete", True)
    assert picture.evaluate("picture => picture.naturalWidth") > 0
    fresh.get_by_text("If it does not open on the other device").click()
    expect(fresh.get_by_label("Link at 192.168.0.7")).to_have_value(re.compile("^http://192.168.0.7:"))


def test_a_token_is_shown_once(fresh: Page, site: Site) -> None:
    page = fresh
    page.goto(f"{site.url}/#/people")
    tokens = page.get_by_role("region", name="Token for a program")
    tokens.get_by_label("Name of the program").fill("depth logger")
    tokens.get_by_role("button", name="Create token").click()
    expect(tokens.get_by_label("Token", exact=True)).to_have_value(re.compile("^mucat_"))
    tokens.get_by_role("button", name="Done").click()
    expect(tokens.get_by_label("Token", exact=True)).to_be_hidden()
    page.get_by_role("button", name="Revoke depth logger").click()
    page.get_by_role("button", name="Revoke", exact=True).click()
    expect(page.get_by_role("row", name=re.compile("depth logger"))).to_be_hidden()


@pytest.mark.parametrize("size", [DESKTOP, PHONE], ids=["desktop", "phone"])
def test_a_dangerous_act_asks_for_a_code_and_is_then_done(
    fresh: Page, site: DiveSite, size: ViewportSize
) -> None:
    clock = SimulatedClock(1000.0)
    site.forget_confirmations(clock)
    fresh.set_viewport_size(size)
    fresh.goto(f"{site.url}/#/people")
    tokens = fresh.get_by_role("region", name="Token for a program")
    tokens.get_by_label("Name of the program").fill(f"logger on {size['width']} px")
    create = tokens.get_by_role("button", name="Create token")
    create.click()
    dialog = fresh.get_by_role("dialog", name="Confirmation needed")
    code = dialog.get_by_label("Operator code or link")
    expect(code).to_be_focused()
    fresh.get_by_role("button", name="STOP").click(trial=True)
    dialog.get_by_role("button", name="Cancel").click()
    expect(dialog).to_be_hidden()
    expect(create).to_be_focused()
    expect(tokens.get_by_role("alert")).to_contain_text("fresh confirmation")

    create.click()
    code.fill("nonsense")
    code.press("Enter")
    expect(dialog.get_by_role("alert")).to_contain_text("does not confirm")
    expect(dialog.get_by_role("button", name="Confirm")).to_be_enabled()
    code.fill(make_link(site, "operator"))
    code.press("Enter")
    expect(tokens.get_by_label("Token", exact=True)).to_have_value(re.compile("^mucat_"))
    expect(dialog).to_be_hidden()

    clock.forward(CONFIRMED_SECONDS)
    fresh.goto(f"{site.url}/#/system")
    fresh.get_by_role("button", name="Download a backup").click()
    code.fill(make_link(site, "operator"))
    with fresh.expect_download() as download:
        code.press("Enter")
    assert download.value.suggested_filename.startswith("mucat-backup-")


def test_the_audit_log_shows_filters_and_saves_who_did_what(fresh: Page, site: Site) -> None:
    name = "<b>Eve</b>"
    code = make_link(site, "viewer").partition("#pair=")[2]
    with httpx.Client(
        base_url=f"{site.url}/api/access", headers={"origin": site.url}, timeout=SECONDS
    ) as eve:
        paired = eve.post("/pair", json={"code": code, "name": name}).raise_for_status().json()
        eve.post("/sign-out", headers={"x-mucat": paired["page_secret"]}).raise_for_status()
    fresh.goto(f"{site.url}/#/people")
    log = fresh.get_by_role("region", name="Audit log")
    rows = log.get_by_role("table").get_by_role("row")
    expect(rows.filter(has_text=name)).to_have_count(2)

    log.get_by_label("Who").fill("eve")
    log.get_by_role("button", name="Show").click()
    expect(rows).to_have_count(3)
    expect(rows.nth(1)).to_contain_text(f"{name}viewer, 127.0.0.1Sign this browser out")
    expect(rows.nth(2)).to_contain_text("Sign this browser in with a code")
    expect(rows.locator("b")).to_have_count(0)
    with fresh.expect_download() as download:
        log.get_by_role("button", name="CSV file").click()
    assert download.value.suggested_filename.endswith(".csv")
    _, newest, oldest = csv.reader(download.value.path().read_text().splitlines())
    assert name in newest
    assert "Sign this browser out" in newest
    assert "Sign this browser in with a code" in oldest

    log.get_by_label("What").fill("no such act")
    log.get_by_role("button", name="Show").click()
    expect(log.get_by_role("status")).to_be_visible()
    expect(rows).to_have_count(0)
