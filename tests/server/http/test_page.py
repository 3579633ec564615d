import asyncio
import gzip
from pathlib import Path

import httpx
import pytest
from fastapi import FastAPI

from server.http.page import Page, make_router


class PageClient:
    """A client of the page's routes."""

    def __init__(self, folder: Path) -> None:
        self._app = FastAPI()
        self._app.include_router(make_router(Page(folder)))

    def get(self, path: str, **headers: str) -> httpx.Response:
        async def ask() -> httpx.Response:
            transport = httpx.ASGITransport(self._app)
            async with httpx.AsyncClient(transport=transport, base_url="http://page") as client:
                return await client.get(path, headers=headers)

        return asyncio.run(ask())


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    page = tmp_path / "page"
    (page / "assets").mkdir(parents=True)
    (page / "index.html").write_text("<p>index</p>")
    (page / "assets" / "main-abc123.js").write_text("run()")
    (page / "assets" / "main-abc123.js.gz").write_bytes(gzip.compress(b"run()"))
    (page / "icon.svg").write_text("<svg/>")
    (tmp_path / "secret.txt").write_text("secret")
    return page


@pytest.fixture
def client(folder: Path) -> PageClient:
    return PageClient(folder)


def test_paths_of_the_page_show_its_index(client: PageClient) -> None:
    for path in ("/", "/operate", "/sessions/3"):
        answer = client.get(path)
        assert (answer.status_code, answer.text) == (200, "<p>index</p>")
        assert answer.headers["cache-control"] == "no-cache"


def test_hashed_files_are_cached_for_ever_and_sent_compressed(client: PageClient) -> None:
    plain = client.get("/assets/main-abc123.js", **{"accept-encoding": "identity"})
    packed = client.get("/assets/main-abc123.js", **{"accept-encoding": "br;q=1, gzip;q=0.8"})
    assert plain.text == packed.text == "run()"
    assert "content-encoding" not in plain.headers
    assert packed.headers["content-encoding"] == "gzip"
    for answer in (plain, packed):
        assert "immutable" in answer.headers["cache-control"]
        assert answer.headers["content-type"].startswith("text/javascript")
        assert answer.headers["vary"] == "accept-encoding"


def test_files_without_a_hash_are_revalidated(client: PageClient) -> None:
    answer = client.get("/icon.svg")
    assert (answer.text, answer.headers["cache-control"]) == ("<svg/>", "no-cache")


def test_a_missing_asset_is_missing_and_not_the_index(client: PageClient) -> None:
    assert client.get("/assets/main-old.js").status_code == 404


@pytest.mark.parametrize(
    "path",
    [
        "../secret.txt",
        "assets/../../secret.txt",
        "/etc/passwd",
        "%2e%2e/secret.txt",
        "a\0b",
        "..",
        "a" * 5000,
    ],
)
def test_no_path_leads_out_of_the_folder(folder: Path, path: str) -> None:
    result = Page(folder).find(path)
    assert result is None or result == folder / "index.html"


def test_links_out_of_the_folder_are_not_followed(folder: Path) -> None:
    (folder / "out").symlink_to(folder.parent / "secret.txt")
    assert Page(folder).find("out") == folder / "index.html"


def test_a_missing_build_is_reported_and_found_once_it_exists(tmp_path: Path) -> None:
    client = PageClient(tmp_path / "page")
    answer = client.get("/")
    assert answer.status_code == 503
    assert "not built" in answer.text
    (tmp_path / "page").mkdir()
    (tmp_path / "page" / "index.html").write_text("built")
    assert client.get("/").text == "built"


def test_the_version_follows_the_build(folder: Path) -> None:
    page = Page(folder)
    first = page.version
    (folder / "index.html").write_text("<p>other</p>")
    assert first
    assert page.version not in ("", first)
    (folder / "index.html").unlink()
    assert page.version == ""
