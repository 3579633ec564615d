"""The Arm panel: how long the robot goes on without a page is chosen, and the hold names it."""

from playwright.sync_api import Page, expect

from tests.pages.dive_site import DiveSite


def test_a_longer_time_without_a_page_is_chosen_and_said_by_the_hold(page: Page, site: DiveSite) -> None:
    before = len(site.commands)
    page.goto(site.url)
    panel = page.get_by_role("region", name="Arm")
    choice = panel.get_by_label("Without a page")
    expect(choice).to_have_value("")
    expect(choice.locator("option").first).to_have_text("it stops after 30 s")
    choice.select_option("it goes on for 5 min")
    button = panel.get_by_role("button", name="Hold to arm, unwatched for 5 min")
    expect(panel.get_by_text("It comes up by itself after 5 min.")).to_be_visible()
    # By hand the pilot's silence stops it, whatever was chosen.
    panel.get_by_role("button", name="Manual", exact=True).click()
    expect(panel.get_by_role("button", name="Hold to arm", exact=True)).to_be_visible()
    panel.get_by_role("button", name="Automatic", exact=True).click()
    with page.expect_response("**/commands/arm"):
        button.focus()
        page.keyboard.press("Enter")
        page.keyboard.press("Enter")
    arm = next(fields for name, fields in site.commands[before:] if name == "arm")
    assert arm == {"unwatched": 300}
    # It counts for one arming.
    expect(choice).to_have_value("")
