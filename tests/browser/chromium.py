"""Debian's Chromium, for tests and measurements, and its sign-in."""

from pathlib import Path

import httpx
from playwright.sync_api import BrowserContext

from server.platform.settings import DataFolder
from tests.shell import ShellToken

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


def sign_in(context: BrowserContext, url: str, data: Path) -> None:
    """Pair this browser with the server of this data folder, as an operator's."""
    with httpx.Client(base_url=f"{url}/api/access", auth=ShellToken(DataFolder(data))) as shell:
        made = shell.post("/codes", json={"role": "operator"}).raise_for_status().json()
    paired = context.request.post(
        f"{url}/api/access/pair", data={"code": made["code"], "name": "Chromium"}, headers={"Origin": url}
    )
    assert paired.ok, paired.text()
