import asyncio
from base64 import b64encode
from hashlib import sha256
from pathlib import Path

import httpx
import pytest
from fastapi import FastAPI

from server.http.help_pages import HelpPages, content_policy, make_help_router
from server.http.security import SecurityMiddleware

HTML = '<script src="x.js"></script><script id="c" type="application/json">{}</script><script>run()</script>'


def get(folder: Path, path: str) -> httpx.Response:
    app = FastAPI()
    app.add_middleware(SecurityMiddleware, allowed_hosts=["help"], port=80)
    app.include_router(make_help_router(HelpPages(folder)))

    async def ask() -> httpx.Response:
        async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://help") as client:
            return await client.get(path)

    return asyncio.run(ask())


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    site = tmp_path / "help"
    (site / "use").mkdir(parents=True)
    (site / "index.html").write_text(HTML)
    (site / "use" / "index.html").write_text("<p>use</p>")
    (site / "404.html").write_text("<p>no such page</p>")
    (site / "bundle.0123abcd.min.js").write_text("run()")
    (site / "index.json").write_text("{}")
    (tmp_path / "secret.txt").write_text("secret")
    return site


def test_a_page_is_found_by_its_folder(folder: Path) -> None:
    assert get(folder, "/help/").text == HTML
    assert get(folder, "/help/use/").text == "<p>use</p>"
    assert get(folder, "/help").headers["location"] == "/help/"
    assert get(folder, "/help/use").headers["location"] == "/help/use/"


def test_only_the_scripts_of_the_page_itself_may_run(folder: Path) -> None:
    policy = get(folder, "/help/").headers["content-security-policy"]
    allowed = b64encode(sha256(b"run()").digest()).decode()
    assert f"script-src 'self' 'sha256-{allowed}';" in policy
    assert "unsafe" not in policy
    assert "script-src 'self';" in content_policy("<p>no script</p>")


def test_a_file_keeps_the_app_s_policy_and_the_other_headers(folder: Path) -> None:
    script = get(folder, "/help/bundle.0123abcd.min.js")
    assert "immutable" in script.headers["cache-control"]
    assert script.headers["content-security-policy"].startswith("default-src 'self'; img-src 'self' blob:")
    assert get(folder, "/help/index.json").headers["cache-control"] == "no-cache"
    # What is no page has the policy of all else: nobody frames it.
    assert script.headers["x-frame-options"] == "DENY"


def test_the_servers_own_page_alone_may_frame_the_help(folder: Path) -> None:
    headers = get(folder, "/help/").headers
    assert headers["x-frame-options"] == "SAMEORIGIN"
    assert "frame-ancestors 'self'" in headers["content-security-policy"]


@pytest.mark.parametrize("path", ["/help/gone", "/help/..%2fsecret.txt", "/help/%00", "/help/" + "a" * 300])
def test_a_missing_page_is_answered_by_the_site_s_own_404_page(folder: Path, path: str) -> None:
    answer = get(folder, path)
    assert (answer.status_code, answer.text) == (404, "<p>no such page</p>")


def test_missing_help_is_answered_with_how_to_build_it(tmp_path: Path) -> None:
    answer = get(tmp_path / "help", "/help/")
    assert answer.status_code == 503
    assert "make setup" in answer.text
