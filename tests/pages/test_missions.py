"""Missions: the library, the editor by keyboard and pointer, TOML both ways, the dry run, and roles."""

import re
import tomllib
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, Locator, Page, Route, expect

from tests.browser.axe import AXE, faults
from tests.browser.code import draft_of, write_code
from tests.browser.people import somebody
from tests.browser.site import Site
from tests.pages.dive_site import DiveSite

VALID = re.compile("Valid · takes")
OWN = """format = 1
name = "{name}"
title = "Pool check"

[mission]
do = "sequence"
steps = [
  {{ do = "dive", depth = 0.5, timeout = 20 }},
  {{ do = "wait_for", sees = "red", timeout = 1, note = "nobody shows it" }},
]
"""


def open_mission(page: Page, site: Site, name: str) -> None:
    page.goto(f"{site.url}/#/missions/edit/{name}")
    expect(page.get_by_text(VALID)).to_be_visible()


def keep(site: Site, name: str) -> None:
    """Store a mission of one's own."""
    site.api.post("/missions", json={"text": OWN.format(name=name)}).raise_for_status()


def card(page: Page, element: str) -> Locator:
    """Return the head of the step at this place."""
    return page.locator("button.head").filter(has=page.get_by_text(element, exact=True))


def places(page: Page) -> list[str]:
    """Return all steps as they stand: the place, and the kind."""
    return [
        " ".join(head.locator(".place, strong").all_inner_texts())
        for head in page.locator("button.head").all()
    ]


def show_toml(page: Page) -> Locator:
    page.get_by_role("button", name="TOML", exact=True).click()
    return page.get_by_role("textbox", name="Mission as TOML")


def tab_to(page: Page, expected: Locator, most: int = 60) -> None:
    """Go on by Tab until it has the focus."""
    expect(expected).to_be_visible()
    for _ in range(most):
        page.keyboard.press("Tab")
        if expected.count() == 1 and expected.evaluate("(one) => one === document.activeElement"):
            return
    raise AssertionError(f"Tab does not reach {expected}")


def test_the_library_lists_duplicates_saves_and_deletes(page: Page, site: Site) -> None:
    page.goto(f"{site.url}/#/missions")
    row = page.get_by_role("row").filter(has_text="Two depths")
    expect(row).to_contain_text("shipped")
    expect(row.get_by_role("button", name="Delete")).to_have_count(0)
    with page.expect_download() as download:
        row.get_by_role("button", name="Download two_depths").click()
    assert download.value.suggested_filename == "two_depths.toml"
    assert tomllib.loads(Path(download.value.path()).read_text())["name"] == "two_depths"

    row.get_by_role("button", name="Duplicate two_depths").click()
    expect(page.get_by_role("heading", level=1, name="Two depths (copy)")).to_be_visible()
    expect(page.get_by_text("Not saved")).to_be_visible()
    page.get_by_role("button", name="Save", exact=True).click()
    expect(page.get_by_role("button", name="Saved", exact=True)).to_be_disabled()
    assert page.url.endswith("#/missions/edit/two_depths_2")

    page.get_by_role("link", name="All missions").click()
    own = page.get_by_role("row").filter(has_text="Two depths (copy)")
    expect(own).to_contain_text("own, version 1")
    own.get_by_role("button", name="Delete two_depths_2").click()
    own.get_by_role("button", name="Delete permanently").click()
    expect(own).to_have_count(0)


def test_a_mission_is_written_from_nothing_by_keyboard_alone(page: Page, site: Site) -> None:
    keyboard = page.keyboard
    tab_to(page, page.get_by_role("link", name="Missions", exact=True))
    keyboard.press("Enter")
    tab_to(page, page.get_by_role("button", name="New mission"))
    keyboard.press("Enter")
    expect(page.get_by_role("heading", level=1)).to_be_focused()

    tab_to(page, page.locator("summary", has_text="Name and limits"))
    keyboard.press("Enter")
    tab_to(page, page.get_by_label("name", exact=True))
    keyboard.press("ControlOrMeta+a")
    keyboard.type("by_keyboard")
    tab_to(page, page.get_by_role("textbox", name=re.compile("^depth")))
    keyboard.type("1.5")

    add = page.get_by_role("button", name="Add a step to the mission")
    for kind, fields in {
        "hold": {"seconds": "3"},
        "dive": {"depth": "0.6"},
        "repeat": {"times": "2"},
        "surface": {},
    }.items():
        if not add.evaluate("(one) => one === document.activeElement"):
            tab_to(page, add)
        keyboard.press("Enter")
        choice = page.get_by_role("button", name=re.compile(f"^{kind} ?[A-Z]"))
        if not choice.evaluate("(one) => one === document.activeElement"):
            tab_to(page, choice)
        keyboard.press("Enter")
        expect(page.locator("button.head").last).to_be_focused()
        for name, value in fields.items():
            tab_to(page, page.locator(".card.open").get_by_role("textbox", name=re.compile(f"^{name}")))
            keyboard.type(value)
    assert places(page) == ["Mission sequence", "1 hold", "2 dive", "3 repeat", "4 surface"]

    # Alt and arrows put the steps in order: dive first, hold into the repetition, out, and in again.
    keyboard.press("ArrowUp")
    keyboard.press("ArrowUp")
    expect(card(page, "2")).to_be_focused()
    keyboard.press("Alt+ArrowUp")
    expect(card(page, "1")).to_be_focused()
    assert places(page)[1:3] == ["1 dive", "2 hold"]
    keyboard.press("ArrowDown")
    keyboard.press("Alt+ArrowRight")
    expect(card(page, "2.1")).to_be_focused()
    assert places(page) == ["Mission sequence", "1 dive", "2 repeat", "2.1 hold", "3 surface"]
    keyboard.press("Alt+ArrowLeft")
    assert places(page)[2:4] == ["2 repeat", "3 hold"]
    keyboard.press("ControlOrMeta+z")
    keyboard.press("ControlOrMeta+z")
    expect(card(page, "3")).to_contain_text("repeat")
    keyboard.press("ControlOrMeta+Shift+Z")
    expect(card(page, "2.1")).to_contain_text("hold")

    expect(page.get_by_text(VALID)).to_be_visible()
    keyboard.press("Shift+Tab")
    tab_to(page, page.get_by_role("button", name="TOML", exact=True))
    keyboard.press("Enter")
    text = draft_of(page, "mucat-mission")
    assert tomllib.loads(text) == {
        "format": 1,
        "name": "by_keyboard",
        "limits": {"depth": 1.5},
        "mission": {
            "do": "sequence",
            "steps": [
                {"do": "dive", "depth": 0.6},
                {"do": "repeat", "times": 2, "steps": [{"do": "hold", "seconds": 3}]},
                {"do": "surface"},
            ],
        },
    }
    save = page.get_by_role("button", name="Save", exact=True)
    for _ in range(60):
        keyboard.press("Shift+Tab")
        if save.evaluate("(one) => one === document.activeElement"):
            break
    keyboard.press("Enter")
    expect(page.get_by_role("button", name="Saved", exact=True)).to_be_visible()
    listed = {mission["name"]: mission for mission in site.api.get("/missions").json()}
    assert listed["by_keyboard"]["text"] == text


def test_problems_are_at_their_card_and_field(page: Page, site: Site) -> None:
    keep(site, "with_problems")
    open_mission(page, site, "with_problems")
    card(page, "1").click()
    depth = page.get_by_role("textbox", name=re.compile("^depth"))
    depth.fill("12")
    expect(depth).to_have_attribute("aria-invalid", "true")
    expect(depth).to_have_accessible_description(re.compile("depth is 12; it must lie between 0 and 10"))
    expect(card(page, "1")).to_contain_text("1 problem")
    expect(card(page, "2")).not_to_contain_text("problem")
    expect(page.get_by_role("button", name="Save", exact=True)).to_be_disabled()
    expect(page.get_by_role("button", name="Hold to start the mission")).to_be_disabled()
    expect(page.get_by_text("The mission is not valid.")).to_be_visible()
    depth.fill("deep")
    expect(depth).to_have_accessible_description(re.compile("“deep” is not a number"))
    expect(depth).to_have_value("deep")

    card(page, "2").click()
    # A closed card says it beneath.
    expect(page.get_by_text(re.compile("^depth .*number"))).to_be_visible()
    page.get_by_role("combobox", name=re.compile("^sees")).fill("")
    expect(page.get_by_text("sees is missing")).to_be_visible()
    page.get_by_role("button", name="Undo").click()
    page.get_by_role("button", name="Undo").click()
    expect(page.get_by_text(VALID)).to_be_visible()
    expect(page.get_by_role("button", name="Saved", exact=True)).to_be_visible()
    page.get_by_role("button", name="Redo").click()
    expect(card(page, "1")).to_contain_text("depth deep")


def test_toml_changes_the_cards_and_cards_write_toml(page: Page, site: Site) -> None:
    keep(site, "both_ways")
    open_mission(page, site, "both_ways")
    toml = show_toml(page)
    text = OWN.format(name="both_ways")
    write_code(
        toml,
        text.replace("depth = 0.5", "depth = 0.7").replace("red", "marker 7") + "\n[trial]\nseconds = 5\n",
    )
    expect(card(page, "1")).to_contain_text("depth 0.7 m")
    expect(card(page, "2")).to_contain_text("sees marker 7")
    card(page, "2").click()
    page.get_by_role("button", name="Duplicate", exact=True).click()
    expect(card(page, "3")).to_be_focused()
    note = page.get_by_role("textbox", name=re.compile("^note"))
    note.fill('a "quoted" \\ remark')
    expect(toml).to_contain_text("quoted")
    document: dict[str, Any] = tomllib.loads(draft_of(page, "mucat-mission"))
    assert document["trial"] == {"seconds": 5}
    assert document["mission"]["steps"][1]["note"] == "nobody shows it"
    assert document["mission"]["steps"][2]["note"] == 'a "quoted" \\ remark'

    write_code(toml, "mission = [")
    expect(page.get_by_text(re.compile("cannot be shown as cards"))).to_be_visible()
    expect(page.get_by_text(re.compile("is not TOML")).first).to_be_visible()
    page.get_by_role("button", name="Undo").click()
    expect(card(page, "3")).to_contain_text("remark")
    assert tomllib.loads(draft_of(page, "mucat-mission")) == document

    write_code(toml, text.replace("red", "purpel"))
    expect(page.get_by_text("with the robot’s vision it would not begin")).to_be_visible()
    expect(page.get_by_text("Step 2: Nothing is called 'purpel'; there are red,")).to_be_visible()
    expect(page.get_by_text(VALID)).to_be_visible()


def test_a_new_mission_left_untouched_blocks_no_other(page: Page, site: Site) -> None:
    page.goto(f"{site.url}/#/missions")
    page.get_by_role("button", name="New mission").click()
    expect(page.get_by_text("Add the first step.")).to_be_visible()
    expect(page.locator(".problem:not(:empty)")).to_have_count(0)
    page.reload()
    expect(page.get_by_text("Add the first step.")).to_be_visible()
    page.goto(f"{site.url}/#/missions/edit/two_depths")
    expect(page.get_by_role("heading", level=1, name="Two depths")).to_be_visible()
    expect(card(page, "1")).to_be_visible()
    expect(page.get_by_role("alert").filter(has_text="unsaved")).to_have_count(0)


def test_an_address_of_no_mission_says_so(page: Page, site: Site) -> None:
    page.goto(f"{site.url}/#/missions/edit/%")
    expect(page.get_by_role("heading", level=1, name="Missions")).to_be_visible()
    expect(page.get_by_text(re.compile("“%”"))).to_be_visible()


def drag(page: Page, element: str, to: Locator, at: tuple[float, float] | None = None) -> None:
    """Drag the step at this place over something, to a position in it."""
    card(page, element).locator("xpath=preceding-sibling::*").hover()
    page.mouse.down()
    to.hover(position=None if at is None else {"x": at[0], "y": at[1]})
    page.mouse.up()


def test_a_card_is_dragged_into_another_list_and_back(page: Page, site: Site) -> None:
    open_mission(page, site, "follow_colour")
    before = places(page)
    drag(page, "2", page.get_by_role("button", name="Add a step to 1", exact=True))
    expect(card(page, "1.6")).to_be_focused()
    expect(card(page, "1.6")).to_contain_text("surface")
    drag(page, "1.6", card(page, "1"), (40, 3))
    expect(card(page, "1")).to_contain_text("surface")
    drag(page, "1", card(page, "2"), (40, 30))
    expect(card(page, "2")).to_be_focused()
    assert places(page) == before
    # Not into itself.
    drag(page, "1", page.get_by_role("button", name="Add a step to 1.5", exact=True))
    assert places(page) == before


def test_unsaved_changes_stay_over_a_reload_and_are_not_lost_silently(page: Page, site: Site) -> None:
    keep(site, "unsaved")
    open_mission(page, site, "unsaved")
    card(page, "1").click()
    page.get_by_role("textbox", name=re.compile("^depth")).fill("0.9")
    expect(page.get_by_text("Not saved")).to_be_visible()
    page.get_by_role("link", name="System", exact=True).click()
    page.get_by_role("link", name="Missions", exact=True).click()
    page.get_by_role("link", name="Continue editing").click()
    expect(card(page, "1")).to_contain_text("depth 0.9 m")
    page.reload()
    expect(card(page, "1")).to_contain_text("depth 0.9 m")

    page.get_by_role("link", name="All missions").click()
    page.get_by_role("link", name="Two depths", exact=True).click()
    alert = page.get_by_role("alert").filter(has_text="“unsaved” has unsaved changes.")
    alert.get_by_role("button", name="Continue with it").click()
    expect(card(page, "1")).to_contain_text("depth 0.9 m")
    expect(alert).to_be_hidden()
    page.get_by_role("link", name="All missions").click()
    page.get_by_role("link", name="Two depths", exact=True).click()
    alert.get_by_role("button", name="Discard them").click()
    expect(page.get_by_role("heading", level=1, name="Two depths")).to_be_visible()
    expect(card(page, "1")).to_contain_text("depth 0.6 m")


def test_an_older_version_is_taken_back(page: Page, site: Site) -> None:
    keep(site, "older")
    open_mission(page, site, "older")
    card(page, "1").click()
    page.get_by_role("textbox", name=re.compile("^depth")).fill("0.8")
    page.get_by_role("button", name="Save", exact=True).click()
    # Until then the list has no second version, which moves the first one down.
    expect(page.get_by_role("button", name="Saved", exact=True)).to_be_visible()
    page.get_by_role("button", name="Versions").click()
    page.get_by_role("button", name="Take this version: 1").click()
    expect(card(page, "1")).to_contain_text("depth 0.5 m")
    page.get_by_role("button", name="Save", exact=True).click()
    expect(page.get_by_text(re.compile("^Version 3"))).to_be_visible()


def test_what_somebody_else_has_saved_meanwhile_is_not_replaced_unasked(page: Page, site: Site) -> None:
    keep(site, "shared")
    open_mission(page, site, "shared")

    def save_both(minutes: int) -> None:
        """Another program saves, then this page."""
        theirs = OWN.format(name="shared").replace("depth = 0.5", f"depth = 0.{minutes}")
        site.api.post("/missions", json={"text": theirs}).raise_for_status()
        write_code(show_toml(page), OWN.format(name="shared") + f"# mine {minutes}\n")
        expect(page.get_by_text(VALID)).to_be_visible()
        page.get_by_role("button", name="Save", exact=True).click()
        expect(
            page.get_by_text("was saved by the shell of this computer since you opened it")
        ).to_be_visible()

    def stored() -> list[str]:
        return [version["text"] for version in site.api.get("/missions/versions/shared").json()]

    save_both(3)
    assert len(stored()) == 2
    page.get_by_role("button", name="Save mine over it").click()
    expect(page.get_by_role("button", name="Saved", exact=True)).to_be_disabled()
    assert "# mine 3" in stored()[0]
    save_both(4)
    page.get_by_role("button", name="Discard mine, open theirs").click()
    expect(show_toml(page)).to_contain_text("depth = 0.4")
    expect(page.get_by_role("button", name="Saved", exact=True)).to_be_disabled()
    assert "depth = 0.4" in stored()[0]


def test_what_is_written_while_it_is_saved_stays(page: Page, site: Site) -> None:
    keep(site, "meanwhile")
    open_mission(page, site, "meanwhile")
    held: list[Route] = []
    page.route(
        "**/api/missions",
        lambda route, asked: held.append(route) if asked.method == "POST" else route.continue_(),
    )
    card(page, "1").click()
    page.get_by_role("textbox", name=re.compile("^depth")).fill("0.8")
    page.get_by_role("button", name="Save", exact=True).click()
    expect(page.get_by_role("button", name="Saving…")).to_be_visible()
    while not held:
        page.wait_for_timeout(10)  # the page says so before its question has come here
    page.get_by_role("button", name="Undo", exact=True).click()
    expect(card(page, "1")).to_contain_text("depth 0.5 m")
    with page.expect_response(
        lambda response: response.request.method == "GET" and response.url.endswith("/api/missions")
    ):
        held[0].continue_()
    expect(page.get_by_role("button", name="Save", exact=True)).to_be_enabled()
    expect(card(page, "1")).to_contain_text("depth 0.5 m")


def test_a_file_is_opened(page: Page, site: Site, tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(OWN.format(name="from_a_file"))
    page.goto(f"{site.url}/#/missions")
    page.get_by_label("Mission as a TOML file").set_input_files(file)
    expect(card(page, "1")).to_contain_text("depth 0.5 m")
    expect(page.get_by_text("Not saved")).to_be_visible()


def test_a_dry_run_shows_its_outcomes_as_a_picture_and_where_it_failed(page: Page, site: Site) -> None:
    keep(site, "tried")
    open_mission(page, site, "tried")
    page.get_by_label("Seeds").fill("3")
    page.get_by_role("button", name="Start the dry run").click()
    picture = page.get_by_role("img", name=re.compile("^Planned depth.* 3 dry runs over it, of which 0 succ"))
    expect(picture).to_be_visible()
    expect(picture.locator("polyline.failed")).to_have_count(3)
    expect(page.get_by_text("0 of 3", exact=True)).to_be_visible()
    expect(page.get_by_text("It saw no red for 1 s.").first).to_be_visible()
    expect(card(page, "2")).to_contain_text("failed in 3 of 3")
    page.get_by_role("button", name="Show step 2").click()
    expect(card(page, "2")).to_be_focused()
    page.get_by_text("All runs").click()
    expect(page.get_by_role("table").get_by_role("row")).to_have_count(4)

    # Also where another view stands beside, the cards do not claim a text that was not tried.
    show_toml(page)
    expect(card(page, "2")).to_contain_text("failed in 3 of 3")
    timeout = page.get_by_role("textbox", name=re.compile("^timeout"))
    timeout.fill("3")
    expect(card(page, "2")).not_to_contain_text("failed in")
    timeout.fill("1")
    expect(card(page, "2")).to_contain_text("failed in 3 of 3")
    page.get_by_role("button", name="Dry run", exact=True).click()

    # Of another text, it says so, and no card claims it.
    page.get_by_role("textbox", name=re.compile("^timeout")).fill("2")
    expect(page.get_by_text("Dry run of an earlier text")).to_be_visible()
    expect(card(page, "2")).not_to_contain_text("failed in")

    page.get_by_label("Seeds").fill("100")
    page.get_by_role("button", name="Start the dry run").click()
    page.get_by_role("button", name="Cancel").click()
    expect(page.get_by_text("It was cancelled.")).to_be_visible()
    expect(page.get_by_role("button", name="Start the dry run")).to_be_enabled()


def hold_to_start(page: Page) -> None:
    hold = page.get_by_role("button", name="Hold to start the mission")
    expect(hold).to_be_enabled()
    hold.focus()
    page.keyboard.press("Enter")
    page.keyboard.press("Enter")


def test_a_start_sends_the_mission_and_a_refusal_is_shown_with_every_reason(
    page: Page, site: DiveSite
) -> None:
    open_mission(page, site, "two_depths")
    site.refuse("The robot cannot be armed: no link. Step 2 sees red: there is no camera.")
    hold_to_start(page)
    refused = page.get_by_role("alert").filter(has_text="The mission was refused")
    expect(refused).to_contain_text("no link. Step 2 sees red: there is no camera.")
    site.refuse(None)
    hold_to_start(page)
    expect(page.get_by_text("Two depths has begun.")).to_be_visible()
    expect(refused).to_be_hidden()
    name, command = site.commands[-1]
    assert name == "mission"
    assert 'name = "two_depths"' in command["text"]


def test_a_viewer_sees_and_checks_and_changes_nothing(browser: Browser, site: Site, tmp_path: Path) -> None:
    with somebody(browser, site, "viewer") as page:
        page.goto(f"{site.url}/#/missions")
        expect(page.get_by_role("button", name="New mission")).to_be_disabled()
        expect(page.get_by_role("button", name="Duplicate two_depths")).to_be_disabled()
        page.get_by_role("link", name="Two depths", exact=True).click()
        expect(page.get_by_text("View only. Operators can change missions.")).to_be_visible()
        card(page, "1").click()
        expect(page.get_by_role("textbox", name=re.compile("^depth")).last).to_be_disabled()
        before = places(page)
        card(page, "1").press("Alt+ArrowDown")
        card(page, "1").press("Delete")
        assert places(page) == before
        for name in ("Add a step to the mission", "Hold to start the mission", "Start the dry run"):
            expect(page.get_by_role("button", name=name)).to_be_disabled()
        expect(show_toml(page)).not_to_be_editable()
        page.get_by_role("link", name="All missions").click()
        file = tmp_path / "bad.toml"
        file.write_text(OWN.format(name="bad").replace("0.5", "50"))
        page.get_by_label("Mission as a TOML file").set_input_files(file)
        expect(page.get_by_text(re.compile("depth is 50; it must lie"))).to_be_visible()


def test_an_open_card_fits_the_screen_and_is_accessible(any_page: Page, site: Site) -> None:
    any_page.evaluate(AXE.read_text())
    keep(site, "accessible")
    open_mission(any_page, site, "accessible")
    card(any_page, "2").click()
    any_page.get_by_role("combobox", name=re.compile("^sees")).fill("")
    expect(any_page.get_by_text("sees is missing")).to_be_visible()
    any_page.locator("summary", has_text="Name and limits").click()
    any_page.get_by_role("button", name="Add a step to the mission").click()
    for view in ("Dry run", "TOML", "Versions"):
        any_page.get_by_role("button", name=view, exact=True).click()
        if view == "TOML":
            # Its editor is fetched.
            expect(any_page.get_by_role("textbox", name="Mission as TOML")).to_be_visible()
        assert faults(any_page) == [], view
    width = any_page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
    inner = any_page.evaluate(
        "document.querySelector('main').scrollWidth - document.querySelector('main').clientWidth"
    )
    assert (width, inner) == (0, 0)


def test_the_checks_before_a_dive_are_ticked_or_say_what_is_not_known(page: Page, site: DiveSite) -> None:
    page.goto(f"{site.url}/#/missions/edit/first_dive")
    checks = page.get_by_role("region", name="Before a dive")
    expect(checks).to_contain_text("swims on to its end, 11:05 at most")
    expect(checks).to_contain_text("GB free")
    expect(checks).to_contain_text("as this device’s")
    expect(checks).to_contain_text("not known now")
    expect(checks).to_contain_text("V, alarm at 6.2 V")
    count = checks.get_by_text(re.compile(r"^\d+ of 11$"))
    before = int(count.inner_text()[0])
    checks.get_by_label("Level at rest").check()
    expect(count).to_have_text(f"{before + 1} of 11")
    expect(checks.get_by_role("link", name="Dive without Wi-Fi")).to_have_attribute(
        "href", "/help/use/dive-without-wifi/"
    )
