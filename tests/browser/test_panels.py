"""Own panels of Operate are isolated."""

import re
import shutil
import socket
from collections.abc import Iterator

import pytest
from playwright.sync_api import Page, expect

from tests.browser.arranging import add, arrange
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


def listen_on_both() -> tuple[socket.socket, socket.socket]:
    """Return a TCP and a UDP socket of the loopback with the same port."""
    tcp = socket.create_server(("127.0.0.1", 0))
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    udp.bind(tcp.getsockname())
    for connection in (tcp, udp):
        connection.setblocking(False)
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
    page.on(
        "response", lambda response: answered.append(response.url) if response.frame.parent_frame else None
    )
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
    assert {address for address in answered if not address.startswith("blob:")} == {
        f"{stack.url}/api/panels/frame"
    }

    # Keys go to the page, also after a click into a panel.
    hold_to_arm(page)
    nosy.get_by_role("button").click()
    expect(nosy.get_by_role("button")).to_have_text("pressed")
    # `:focus` matches no frame in Chromium, wherever the keys go.
    page.wait_for_function("() => document.activeElement.tagName !== 'IFRAME'")
    page.keyboard.press("Escape")
    expect(page.get_by_text("Disarmed", exact=True)).to_be_visible()
