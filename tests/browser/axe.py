"""Violations of accessibility on a page, as axe-core finds them."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from playwright.sync_api import Browser, Page, StorageState, ViewportSize

from tests.browser.opening import PHONE
from tests.browser.pages import View, fill, show
from tests.browser.site import Site
from tests.stack import ROOT

AXE = ROOT / "frontend/node_modules/axe-core/axe.min.js"
USUAL = "document, { resultTypes: ['violations'] }"
PALE = "['.dimmed', '.stale', '.old', '[style*=background]']"
FOR_SUNLIGHT = f"{{ exclude: {PALE} }}, {{ runOnly: ['color-contrast-enhanced'] }}"
"""7:1, but for what is too old to be trusted, and on colours that are data, where black or white reach 4.5:1.

Colours are all that differs in that theme.
"""
GRAVE = {"serious", "critical"}
WITHOUT_LESS = """axe.configure({
    rules: axe._audit.rules
        .filter(({ impact }) => impact === 'minor' || impact === 'moderate')
        .map(({ id }) => ({ id, enabled: false })),
})"""
"""Leaves out the rules whose faults are never grave; one of them looks at every element of a page."""


@contextmanager
def opened_for_axe(browser: Browser, site: Site, cookies: StorageState, size: ViewportSize) -> Iterator[Page]:
    """A page with axe-core on a server that has sessions."""
    fill(site)
    context = browser.new_context(
        viewport=size,
        storage_state=cookies,
        has_touch=size == PHONE,
        reduced_motion="reduce",
        color_scheme="dark",
    )
    page = context.new_page()
    context.add_init_script(path=AXE)
    page.goto(site.url)
    yield page
    context.close()


def faults(page: Page, how: str = USUAL) -> list[str]:
    """Violations on the present page: the rule, and the place."""
    result: dict[str, Any] = page.evaluate(f"() => {{ {WITHOUT_LESS}; return axe.run({how}); }}")
    return [
        f"{fault['id']}: {fault['help']}: {node['target']} {node.get('failureSummary', '')}"
        for fault in result["violations"]
        if fault["impact"] in GRAVE
        for node in fault["nodes"][:3]
    ]


def faults_in_both_themes(page: Page) -> list[str]:
    """Violations on the present page in both themes; the dark one is left on."""
    dark = faults(page)
    page.evaluate("document.documentElement.dataset.theme = 'sunlight'")
    sunlight = faults(page, FOR_SUNLIGHT)
    page.evaluate("document.documentElement.dataset.theme = 'dark'")
    return dark + sunlight


def faults_of_view(page: Page, site: Site, view: View) -> list[str]:
    """Violations of a page in both themes."""
    show(page, site, view)
    return faults_in_both_themes(page)
