"""The page that the frontend's build has put into one folder."""

from hashlib import sha256
from pathlib import Path

from fastapi import APIRouter, Request, Response
from starlette.responses import FileResponse, HTMLResponse

HASHED_FOLDER = "assets"
"""Vite puts a hash of the content into the names of what lies here."""
FOR_EVER = "public, max-age=31536000, immutable"
ASK_AGAIN = "no-cache"
NOT_BUILT = (
    "<!doctype html><title>µ-CAT</title><p>The page is not built yet: “make run” builds it. Then reload.</p>"
)


class Page:
    """The built page in `folder`; it may be built, and built anew, while the server runs."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder.resolve()

    @property
    def version(self) -> str:
        """The build's version; empty where the page is not built."""
        try:
            return sha256((self._folder / "index.html").read_bytes()).hexdigest()[:12]
        except OSError:
            return ""

    def find(self, path: str) -> Path | None:
        """Return the file at `path`, or the index for the page's own paths; None where there is none."""
        index = self._folder / "index.html"
        try:
            file = (self._folder / path).resolve()
            if file.is_relative_to(self._folder) and file.is_file():
                return file
            # A page of an older build must not take the index for its script.
            return index if index.is_file() and not path.startswith(HASHED_FOLDER + "/") else None
        except (OSError, ValueError):
            # No file can have such a name.
            return None

    def respond(self, path: str, *, gzip: bool) -> Response:
        """Return the answer to a request for `path`; `gzip`: the browser takes it compressed."""
        file = self.find(path)
        if file is None:
            built = (self._folder / "index.html").is_file()
            return Response(status_code=404) if built else HTMLResponse(NOT_BUILT, status_code=503)
        hashed = file.relative_to(self._folder).parts[0] == HASHED_FOLDER
        headers = {"cache-control": FOR_EVER if hashed else ASK_AGAIN, "vary": "accept-encoding"}
        compressed = file.with_name(file.name + ".gz")
        if gzip and compressed.is_file():
            media_type = FileResponse(file).media_type
            return FileResponse(
                compressed, headers={**headers, "content-encoding": "gzip"}, media_type=media_type
            )
        return FileResponse(file, headers=headers)


def make_router(page: Page) -> APIRouter:
    """Return the route of everything outside /api, to be added last."""
    router = APIRouter(include_in_schema=False)

    @router.get("/{path:path}")
    def get_page(request: Request, path: str) -> Response:
        encodings = [
            encoding.split(";")[0].strip()
            for encoding in request.headers.get("accept-encoding", "").split(",")
        ]
        return page.respond(path, gzip="gzip" in encodings)

    return router
