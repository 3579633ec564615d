"""The help pages under /help, which `make setup` builds from docs/. They hold no secrets and need no sign-in.

The site generator writes scripts into its pages. Each page's policy names the hashes of its own scripts, so
that no other inline script runs; the app's policy stays without any.
"""

import re
from base64 import b64encode
from hashlib import sha256
from pathlib import Path

from fastapi import APIRouter, Response
from starlette.responses import FileResponse, HTMLResponse, RedirectResponse

from server.http.page import ASK_AGAIN, FOR_EVER

PREFIX = "/help"
NOT_BUILT = "<!doctype html><title>Help</title><p>The help is not built: run “make setup”, then reload.</p>"
_INLINE_SCRIPT = re.compile(
    r"<script(?![^>]*\bsrc=)(?![^>]*\bapplication/json\b)[^>]*>(.*?)</script>", re.DOTALL
)
_HASHED_NAME = re.compile(r"\.[0-9a-f]{8}\.")


class HelpPages:
    """The built site in `folder`; it may be built anew while the server runs."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder.resolve()

    def respond(self, path: str) -> Response:
        """Return the answer to a request for `path` below /help/."""
        target = self._find(path)
        if target is None:
            missing = self._folder / "404.html"
            if not missing.is_file():
                return HTMLResponse(NOT_BUILT, status_code=503)
            return _html(missing, status_code=404)
        if target.is_dir():
            return RedirectResponse(f"{PREFIX}/{path}/")
        if target.suffix == ".html":
            return _html(target)
        cached = FOR_EVER if _HASHED_NAME.search(target.name) else ASK_AGAIN
        return FileResponse(target, headers={"cache-control": cached})

    def _find(self, path: str) -> Path | None:
        """Return the file at `path`, or the folder of a path without its slash; None without either."""
        try:
            file = (self._folder / path).resolve()
            if not file.is_relative_to(self._folder):
                return None
            index = file / "index.html"
            if index.is_file():
                return index if path.endswith("/") or not path else file
            return file if file.is_file() else None
        except (OSError, ValueError):
            # No file can have such a name.
            return None


def _html(file: Path, status_code: int = 200) -> HTMLResponse:
    text = file.read_text(encoding="utf-8")
    headers = {
        "cache-control": ASK_AGAIN,
        "content-security-policy": content_policy(text),
        "x-frame-options": "SAMEORIGIN",
    }
    return HTMLResponse(text, status_code, headers)


def content_policy(html: str) -> str:
    """Return the Content-Security-Policy of a help page: this server alone, and the page's own scripts.

    The server's own page may frame it, and no other.
    """
    hashes = {sha256(script.encode()).digest() for script in _INLINE_SCRIPT.findall(html)}
    scripts = " ".join(["'self'", *sorted(f"'sha256-{b64encode(digest).decode()}'" for digest in hashes)])
    return (
        f"default-src 'self'; script-src {scripts}; img-src 'self' data:; object-src 'none'; "
        "base-uri 'none'; form-action 'self'; frame-ancestors 'self'"
    )


def make_help_router(pages: HelpPages) -> APIRouter:
    """Return everything under /help."""
    router = APIRouter(include_in_schema=False)

    @router.get(PREFIX)
    def open_help() -> Response:
        return RedirectResponse(PREFIX + "/")

    @router.get(PREFIX + "/{path:path}")
    def get_help(path: str) -> Response:
        return pages.respond(path)

    return router
