"""Foxglove Studio from npm, unmodified, as a web page that shows one of the shipped layouts."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Literal
from urllib.parse import urlencode

from tests.browser.site import Site
from tests.stack import ROOT

CLIENTS = ROOT / "tests/clients"
PACKAGES = CLIENTS / "node_modules"
LAYOUTS = ROOT / "server/features/doors/documents"


class _QuietHandler(SimpleHTTPRequestHandler):
    """Serves files without a word about each."""

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - its base names it so
        """Say nothing."""


@contextmanager
def serve_studio(folder: Path) -> Iterator[str]:
    """The address of the program, whose files are linked into this folder."""
    links = {
        "assets": PACKAGES / "@foxglove/studio-base/assets",
        "react": PACKAGES / "react/umd",
        "react-dom": PACKAGES / "react-dom/umd",
        "layouts": LAYOUTS,
        "index.html": CLIENTS / "studio/index.html",
        "studio.js": CLIENTS / "studio/studio.js",
    }
    for name, target in links.items():
        (folder / name).symlink_to(target)
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(_QuietHandler, directory=str(folder))) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        yield f"http://127.0.0.1:{server.server_port}/index.html"
        server.shutdown()
        thread.join()


def studio_address(program: str, site: Site, layout: Literal["foxglove", "lichtblick"]) -> str:
    """Return the address at which the program opens the site's Foxglove door, with a new token."""
    made = site.api.post("/access/tokens", json={"name": "Studio", "scope": "operate"}).raise_for_status()
    door = f"ws://127.0.0.1:{site.port}/foxglove?token={made.json()['token']}"
    query = {"layout": f"layouts/{layout}.json", "ds": "foxglove-websocket", "ds.url": door}
    return f"{program}?{urlencode(query)}"
