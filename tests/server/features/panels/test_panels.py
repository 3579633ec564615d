"""Own panels: the files that count as panels, and the frame that isolates them."""

import os
import re
import subprocess
from base64 import b64encode
from hashlib import sha256
from pathlib import Path

import pytest

from server.features.panels import scripts
from server.features.panels.frame import FRAME
from server.features.panels.scripts import SCRIPT_BYTES_MAX, UnknownPanelError, list_panels, read_panel
from server.platform.settings import Settings
from tests.server.serving import Served, serve


def put(folder: Path, name: str, script: bytes = b"export default () => () => {}") -> None:
    folder.mkdir(exist_ok=True)
    (folder / name).write_bytes(script)


def test_scripts_in_the_folder_are_panels(tmp_path: Path) -> None:
    folder = tmp_path / "panels"
    assert list_panels(folder) == []
    for name in ("Climb rate.js", "no panel.txt", "ünï.js"):
        put(folder, name)
    put(folder, "large.js", b" " * (SCRIPT_BYTES_MAX + 1))
    put(folder, "latin.js", "// °".encode("latin-1"))
    (folder / "gone.js").symlink_to(folder / "nowhere")
    panels = {panel.name: panel.problem for panel in list_panels(folder)}
    assert panels == {
        "Climb rate": "",
        "gone": "gone.js cannot be read: No such file or directory.",
        "large": "large.js has more than 200 kB.",
        "latin": "latin.js has a byte in line 1 that is not UTF-8; it is probably saved as Windows-1252 or "
        "Latin-1: save it as UTF-8.",
        "ünï": "ünï.js needs another name: up to 40 letters without accents, digits, spaces, - and _.",
    }
    assert "export default" in read_panel(folder, "Climb rate").script


def test_a_list_of_panels_has_an_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scripts, "PANELS_SHOWN", 2)
    for name in ("c.js", "a.js", "b.js"):
        put(tmp_path / "panels", name)
    assert [panel.name for panel in list_panels(tmp_path / "panels")] == ["a", "b"]
    assert read_panel(tmp_path / "panels", "c").name == "c"


@pytest.mark.parametrize("name", ["../secret", "secret", "..", "Climb rate.js", "large", "\0"])
def test_no_other_file_is_read(tmp_path: Path, name: str) -> None:
    folder = tmp_path / "panels"
    put(folder, "Climb rate.js")
    put(folder, "large.js", b" " * (SCRIPT_BYTES_MAX + 1))
    put(tmp_path, "secret.js")
    with pytest.raises(UnknownPanelError):
        read_panel(folder, name)


def test_webrtc_is_gone_before_a_panel_opens() -> None:
    """The frame's script in Node, with WebRTC as a browser has it; `ready` asks for the panel's script."""
    (script,) = re.findall(r"<script>(.*)</script>", FRAME, re.DOTALL)
    browser = """
        for (const name of ['RTCPeerConnection', 'webkitRTCPeerConnection', 'RTCDataChannel', 'XRTC'])
          Object.defineProperty(globalThis, name, { value: class {}, configurable: true, writable: true });
        const left = () => ['RTCPeerConnection', 'webkitRTCPeerConnection', 'RTCDataChannel', 'XRTC']
          .filter((name) => name in globalThis).join();
        globalThis.parent = { postMessage: ({ op }) => console.log(op, left()) };
        globalThis.addEventListener = () => {};
    """
    done = subprocess.run(["node", "-e", f"{browser}{script}"], capture_output=True, text=True, check=True)
    assert done.stdout == "ready XRTC\n"


async def test_panels_are_listed_and_served(settings: Settings) -> None:
    put(settings.data.panels, "Climb rate.js", b"// hello")
    # From an archive whose names are in Latin-1.
    put(settings.data.panels, os.fsdecode(b"tief\xe4.js"))

    async with serve(settings) as served:
        fine, odd = (await served.api.get("/panels")).json()
        assert fine == {"name": "Climb rate", "problem": ""}
        assert (odd["name"], "needs another name" in odd["problem"]) == ("tief\ufffd", True)
        script = await served.api.get("/panels/own/Climb%20rate")
        assert script.json() == {"name": "Climb rate", "script": "// hello"}
        gone = await served.api.get("/panels/own/nothing")
        assert gone.status_code == 404
        assert "There is no panel “nothing”" in gone.json()["detail"]


async def test_only_the_panel_s_frame_has_its_own_content_policy(served: Served) -> None:
    frame = await served.api.get("/panels/frame")
    policy = frame.headers["content-security-policy"]
    assert "sandbox allow-scripts;" in policy
    assert "allow-same-origin" not in policy
    assert "default-src 'none'" in policy
    assert "frame-ancestors 'self'" in policy
    assert "connect-src" not in policy  # by default-src
    (script,) = re.findall(r"<script>(.*?)</script>", frame.text, re.DOTALL)
    assert f"'sha256-{b64encode(sha256(script.encode()).digest()).decode()}'" in policy
    assert frame.headers["x-frame-options"] == "SAMEORIGIN"
    assert frame.headers["x-content-type-options"] == "nosniff"
    other = await served.api.get("/panels")
    assert "frame-ancestors 'none'" in other.headers["content-security-policy"]
    assert other.headers["x-frame-options"] == "DENY"
    nobody = await served.api.get("/panels/frame", auth=None, headers={"authorization": ""})
    assert nobody.status_code == 401
    assert "frame-ancestors 'none'" in nobody.headers["content-security-policy"]
