"""The panels of Operate: arranged by keys and mouse, stored by name; own panels, isolated."""

import json
import re
import shutil
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.driving import hold_to_arm
from tests.stack import ROOT, Stack

NOSY = """
export const topics = ['depth', 'nothing'];
export default async function panel(root) {
  // To the port of the test's own listeners, as STUN over UDP and TURN over TCP.
  const call = async (Peer) => {
    const turn = { urls: 'turn:127.0.0.1:PORT?transport=tcp', username: 'a', credential: 'b' };
    const peer = new Peer({ iceServers: [{ urls: 'stun:127.0.0.1:PORT' }, turn] });
    peer.createDataChannel('data');
    await peer.setLocalDescription(await peer.createOffer());
  };
  const tries = {
    state: () => fetch('/api/robot').then((answer) => answer.text()),
    arm: () => fetch('/api/robot/commands/arm', { method: 'POST', headers: { 'X-Mucat': 'page' } }),
    blind: () => fetch('/api/robot/stop', { method: 'POST', mode: 'no-cors', credentials: 'include' }),
    socket: () => new Promise((resolve, reject) => {
      const socket = new WebSocket(location.href.replace(/^http(.*)panels.frame/, 'ws$1live'));
      socket.onopen = resolve;
      socket.onerror = reject;
    }),
    picture: () => new Promise((resolve, reject) => {
      const image = new Image();
      image.onload = resolve;
      image.onerror = reject;
      image.src = '/favicon.svg';
    }),
    page: () => parent.document.title,
    storage: () => localStorage.length,
    cookie: () => document.cookie,
    away: () => { top.location.href = 'about:blank'; },
    script: () => (0, eval)('1'),
    peer: () => call(RTCPeerConnection),
    webkit: () => call(webkitRTCPeerConnection),
    frame: () => {
      const frame = document.createElement('iframe');
      document.body.append(frame);
      return call(frame.contentWindow.RTCPeerConnection);
    },
  };
  const got = [];
  for (const [name, go] of Object.entries(tries)) {
    try { await go(); got.push(name); } catch { /* refused, as it should be */ }
  }
  root.innerHTML = `<p id="got">${got.join(' ') || 'nothing'}</p><output></output><button>press</button>`;
  root.querySelector('button').onclick = (event) => { event.target.textContent = 'pressed'; };
  const output = root.querySelector('output');
  return ({ rows }) => { output.textContent = rows.depth.at(-1)?.depth ?? output.textContent; };
}
"""


@pytest.fixture
def fresh(page: Page, stack: Stack) -> Iterator[Page]:
    """The page; afterwards the server has no layout and no panel."""
    yield page
    for layout in stack.api.get("/layouts").json():
        stack.api.delete(f"/layouts/{layout['id']}").raise_for_status()
    shutil.rmtree(stack.data / "panels", ignore_errors=True)


def arrange(page: Page) -> Locator:
    page.get_by_role("button", name="Arrange", exact=True).click()
    bar = page.get_by_role("region", name="Arrange the panels")
    expect(bar).to_be_visible()
    return bar


def handle(page: Page, title: str) -> Locator:
    return page.get_by_role("application", name=re.compile(f"^{title}: "))


def add(page: Page, bar: Locator, title: str) -> None:
    bar.get_by_role("button", name="Add a panel").click()
    bar.get_by_role("button", name=re.compile(f"^{title}")).click()
    expect(handle(page, title)).to_be_focused()


def drag(page: Page, what: Locator, to: Locator) -> None:
    source, target = what.bounding_box(), to.bounding_box()
    assert source is not None
    assert target is not None
    page.mouse.move(source["x"] + source["width"] / 2, source["y"] + 20)
    page.mouse.down()
    page.mouse.move(target["x"] + target["width"] / 2, target["y"] + target["height"] / 2, steps=4)
    page.mouse.up()


def test_panels_are_arranged_stored_and_reset(fresh: Page, stack: Stack) -> None:
    page = fresh
    camera = page.get_by_role("region", name="Camera")
    expect(camera).to_be_visible()
    expect(page.get_by_role("application", name=re.compile("column"))).to_have_count(0)
    bar = arrange(page)
    told = bar.get_by_role("status")

    handle(page, "Attitude").press("ArrowDown")
    expect(told).to_have_text("Attitude and Fins swapped places.")
    expect(handle(page, "Fins")).to_have_accessible_name("Fins: column 18, row 1, 7 wide, 6 high")
    handle(page, "Camera").press("Shift+ArrowLeft")
    expect(told).to_have_text("Camera: 16 wide, 11 high.")
    handle(page, "Camera").press("Shift+ArrowRight")
    handle(page, "Camera").press("Shift+ArrowRight")
    expect(handle(page, "Attitude")).to_have_accessible_name("Attitude: column 19, row 7, 6 wide, 6 high")
    expect(handle(page, "Fins")).to_have_accessible_name("Fins: column 19, row 1, 6 wide, 6 high")
    handle(page, "Camera").press("Shift+ArrowRight")
    expect(told).to_have_text("Fins cannot be smaller.")

    drag(page, handle(page, "Navigation command"), handle(page, "Events"))
    expect(told).to_have_text("Navigation command and Events swapped places.")
    handle(page, "Console").press("Delete")
    add(page, bar, "Chart")
    bar.get_by_role("button", name="Undo").click()
    expect(handle(page, "Chart")).to_have_count(0)
    add(page, bar, "Chart")
    bar.get_by_role("button", name="Save", exact=True).click()
    bar.get_by_label("Name of the layout").fill("pool day")
    page.keyboard.press("Enter")
    expect(told).to_have_text("Saved as “pool day”.")
    bar.get_by_role("button", name="Done").click()

    chart = page.get_by_role("region", name=re.compile("^Chart"))
    chart.get_by_role("button", name="Choose signals").click()
    chart.get_by_label("Search signals").fill("pressure")
    chart.get_by_role("checkbox", name=re.compile("^pressure")).check()
    chart.get_by_role("button", name="Done").click()
    chosen = page.get_by_label("Layout of the panels")
    expect(chosen.locator("option:checked")).to_have_text("pool day (changed)")

    page.reload()
    expect(page.get_by_role("region", name="Chart of pressure")).to_be_visible()
    expect(page.get_by_role("region", name="Console")).to_have_count(0)
    chosen.select_option("pool day")
    expect(page.get_by_role("region", name="Chart", exact=True)).to_be_visible()

    arrange(page).get_by_role("button", name="Reset").click()
    page.get_by_role("button", name="Done").click()
    expect(page.get_by_role("region", name="Console")).to_be_visible()
    expect(chart).to_have_count(0)
    assert [one["name"] for one in stack.api.get("/layouts").json()] == ["pool day"]


def test_a_layout_of_another_version_is_refused(fresh: Page, tmp_path: Path) -> None:
    page = fresh
    bar = arrange(page)
    bar.get_by_role("button", name="File").click()
    with page.expect_download() as download:
        bar.get_by_role("button", name="Save to a file").click()
    layout = json.loads(download.value.path().read_text())
    file = tmp_path / "theirs.layout.json"
    before = [one.get_attribute("aria-label") for one in page.get_by_role("application", name="column").all()]
    assert len(before) == 8

    bar.get_by_role("button", name="File").click()
    file.write_text(json.dumps(layout | {"version": 2, "panels": []}))
    bar.get_by_label("Open a layout file").set_input_files(file)
    expect(bar.get_by_role("alert")).to_have_text(
        "This layout has version 2. This program reads version 1. Nothing was changed."
    )
    after = [one.get_attribute("aria-label") for one in page.get_by_role("application", name="column").all()]
    assert after == before

    unknown = {"id": "a", "panel": "sonar", "x": 0, "y": 0, "width": 6, "height": 6}
    file.write_text(json.dumps(layout | {"panels": [unknown]}))
    bar.get_by_label("Open a layout file").set_input_files(file)
    expect(handle(page, "Unknown panel “sonar”")).to_be_visible()
    bar.get_by_role("button", name="Done").click()
    expect(page.get_by_role("region", name="sonar")).to_contain_text("which this version does not have")


def listen_on_both() -> tuple[socket.socket, socket.socket]:
    """A TCP and a UDP socket of the loopback with the same port."""
    tcp = socket.create_server(("127.0.0.1", 0))
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    udp.bind(tcp.getsockname())
    for one in (tcp, udp):
        one.setblocking(False)
    return tcp, udp


def test_an_own_panel_gets_samples_and_has_no_other_access(fresh: Page, stack: Stack) -> None:
    page = fresh
    folder = stack.data / "panels"
    folder.mkdir()
    shutil.copy(ROOT / "docs/use/climb-rate.js", folder)
    listeners = listen_on_both()
    (folder / "nosy.js").write_text(NOSY.replace("PORT", str(listeners[0].getsockname()[1])))
    (folder / "broken.js").write_text("export default 1;")
    answered: list[str] = []
    page.on("response", lambda one: answered.append(one.url) if one.frame.parent_frame else None)
    bar = arrange(page)
    for title in ("Climb rate", "Nosy", "Broken"):
        add(page, bar, title)
    bar.get_by_role("button", name="Done").click()

    shown = page.frame_locator("iframe[title='Climb rate']").get_by_role("status")
    expect(shown).to_have_text(re.compile(r"\d\.\d\d"))
    broken = page.get_by_role("region", name="Broken")
    expect(broken).to_contain_text("Error in panels/broken.js: it exports no default function")
    nosy = page.frame_locator("iframe[title='Nosy']")
    expect(nosy.locator("output")).to_have_text(re.compile(r"\d"))
    expect(nosy.locator("#got")).to_have_text("nothing")
    stream, datagrams = listeners
    with stream, pytest.raises(BlockingIOError):
        stream.accept()
    with datagrams, pytest.raises(BlockingIOError):
        datagrams.recv(1)
    assert {one for one in answered if not one.startswith("blob:")} == {f"{stack.url}/api/panels/frame"}

    # Keys go to the page, also after a click into a panel.
    hold_to_arm(page)
    nosy.get_by_role("button").click()
    expect(nosy.get_by_role("button")).to_have_text("pressed")
    page.wait_for_function("document.activeElement?.tagName !== 'IFRAME'")
    page.keyboard.press("Escape")
    expect(page.get_by_text("Disarmed", exact=True)).to_be_visible()
