"""Help: it renders, its search works, no request leaves the robot; each page has its chapter and title."""

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser.opening import DESKTOP, PHONE
from tests.browser.pages import PAGES, fill, show
from tests.browser.site import Site


@pytest.mark.parametrize("window", [DESKTOP, PHONE], ids=["desktop", "phone"])
@pytest.mark.parametrize("colours", ["light", "dark"])
def test_the_help_renders_and_searches_without_a_foreign_request(
    browser: Browser, site: Site, window: object, colours: str
) -> None:
    # Nobody is signed in: who reaches the server may read.
    context = browser.new_context(viewport=window, color_scheme=colours)  # type: ignore[arg-type]
    page = context.new_page()
    requests: list[str] = []
    complaints: list[str] = []
    page.on("request", lambda request: requests.append(request.url))
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(f"{site.url}/help/")
    expect(page.get_by_role("heading", level=1, name="µ-CAT")).to_be_visible()
    scheme = {"light": "default", "dark": "slate"}[colours]
    expect(page.locator("body")).to_have_attribute("data-md-color-scheme", scheme)
    if window == PHONE:
        page.locator("label[for=__search]").first.click()
    element = page.locator(".md-search-result__link").first
    # Typed, key by key: the search reads the field when a key is released.
    page.get_by_role("textbox", name="Search").press_sequentially("overshoot")
    expect(element).to_be_visible()
    element.click()
    expect(page.get_by_role("heading", level=1)).to_be_visible()
    context.close()
    assert [url for url in requests if not url.startswith(f"{site.url}/help/")] == []
    assert complaints == []


def test_each_page_links_to_its_chapter_and_has_a_title_that_begins_with_its_heading(
    any_page: Page, site: Site
) -> None:
    fill(site)
    chapters: dict[str, str] = {}
    titles: dict[str, str] = {}
    for view in PAGES:
        show(any_page, site, view)
        link = any_page.get_by_role("link", name="Help for this page")
        chapters[view.name] = link.get_attribute("href") or ""
        heading = any_page.get_by_role("heading", level=1)
        expect(heading).to_have_count(1)
        expect(any_page).to_have_title(f"{' '.join((heading.text_content() or '').split())} · µ-CAT")
        titles[view.name] = any_page.title()
    assert chapters["operate"] == "/help/use/operate/"
    assert len(set(chapters.values())) >= 9
    for address in sorted(set(chapters.values())):
        path, _, anchor = address.partition("#")
        answer = any_page.request.get(site.url + path)
        assert answer.status == 200, address
        assert not anchor or f'id="{anchor}"' in answer.text(), address
    assert titles["operate"] == "Operate · µ-CAT"
    assert titles["sessions"] == "Sessions · µ-CAT"
    views = [name for name in titles if name.startswith(("tune-", "session-")) or name == "sweeps"]
    # Tune's views are one page, so are those of scenarios, and those of a session have its name.
    assert len(set(titles.values())) >= len(PAGES) - len(views) + 1, titles
