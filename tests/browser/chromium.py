"""Debian's Chromium, for tests and measurements, and its sign-in."""

import json
from pathlib import Path

import httpx
from playwright.sync_api import BrowserContext

from server.platform.settings import DataFolder
from tests.shell import ShellAuth
from tests.waiting import SECONDS

EXECUTABLE = Path(__file__).with_name("chromium.sh")
"""The whole browser, for the benchmark, the screenshots, and what needs a window."""
HEADLESS_SHELL = Path(__file__).with_name("headless_shell.sh")
"""Its engine without windows: what the tests look at. A new page takes it a third of the browser's time."""
ARGUMENTS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


SECRET = "mucat.page_secret"
"""The key under which the page stores its part of the sign-in."""
GUIDE = "mucat-guide"
NO_GUIDE = '{"shown":false}'
"""The page's entry of a browser that wants no card of the first dive."""
DIVED = f"if (self === top && location.protocol !== 'about:') localStorage.setItem('{GUIDE}', '{NO_GUIDE}')"
"""A script of a browser whose person has dived before."""


def sign_in(context: BrowserContext, url: str, data: Path) -> str:
    """Pair this browser with the server of this data folder, as an operator's who has dived before.

    Return its page's secret.
    """
    with httpx.Client(
        base_url=f"{url}/api/access", timeout=SECONDS, auth=ShellAuth(DataFolder(data))
    ) as shell:
        made = shell.post("/codes", json={"role": "operator"}).raise_for_status().json()
    paired = context.request.post(
        f"{url}/api/access/pair", data={"code": made["code"], "name": "Chromium"}, headers={"Origin": url}
    )
    assert paired.ok, paired.text()
    secret: str = paired.json()["page_secret"]
    # Panels in frames may not store anything.
    own = f"self === top && location.origin === {json.dumps(url)}"
    context.add_init_script(f"if ({own}) localStorage.setItem({json.dumps(SECRET)}, {json.dumps(secret)})")
    context.add_init_script(DIVED)
    return secret
