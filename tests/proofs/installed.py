"""The wheels in a root file system: installed as docs/run/packages.md says, and run on a board outside."""

import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import httpx
import psutil

from bench.real_robot import board_outside, store_picture
from server.platform.pidfile import running_parts
from server.platform.settings import DataFolder
from tests.control import Commander
from tests.documents.blocks import read_blocks
from tests.proofs.roots import RootSystem
from tests.shell import ShellAuth
from tests.stack import free_port

PATIENCE = 300.0
"""s; a foreign processor is emulated, some fifteen times slower."""
PLACE = "/opt/release"
ENVIRONMENT = f"{PLACE}/mucat"
MUCAT = f"{ENVIRONMENT}/bin/mucat"
DATA = "var/lib/mucat"
CONFIG = """[robot]
mode = "robot"
[link]
port = "{port}"
baud = {baud}
reset = "dtr"
[vision]
camera = "file"
file = "/etc/card.png"
"""
"""The camera shows one picture: to draw others is no work of a robot."""


def install_wheels(root: RootSystem) -> float:
    """Install the wheels in place of those before, by the commands of the page. Return s it took."""
    began = time.monotonic()
    root.run("rm", "-rf", PLACE, f"/{DATA}")
    root.run("mkdir", "-p", PLACE)
    (block,) = [block for block in read_blocks("run/packages.md") if block.title == root.page]
    # apt has installed its part when the root was made.
    lines = [line for line in block.text.splitlines() if not line.startswith(("sudo apt", "mucat/bin/mucat"))]
    assert len(lines) == 2, f"the page has {lines}"
    root.run("sh", "-euc", "\n".join([f"cd {PLACE}", "ln -s /wheels/* .", *lines]))
    return time.monotonic() - began


@contextmanager
def config_with_board(baud: int) -> Iterator[str]:
    """The configuration of a robot whose port is the line of an emulated board in water, outside."""
    with TemporaryDirectory(prefix="mucat-") as name, board_outside(Path(name), baud) as (port, _):
        yield CONFIG.format(port=port, baud=baud)


class InstalledRobot:
    """`mucat run` in a root, seen from outside."""

    def __init__(self, root: RootSystem, config: str | None) -> None:
        self.port = free_port()
        self.url = self.first = f"http://127.0.0.1:{self.port}"
        self.data = root.path / DATA
        self.api = Commander(base_url=f"{self.url}/api", timeout=60.0, auth=ShellAuth(DataFolder(self.data)))
        text = [MUCAT, "run", "--port", str(self.port), "--data", f"/{DATA}"]
        if config is not None:
            (root.path / "etc/robot.toml").write_text(config)
            store_picture(root.path / "etc/card.png")
            text += ["--config", "/etc/robot.toml"]
        self._log = (root.path / "var/log/mucat.log").open("wb")
        self._began = time.monotonic()
        self._process = subprocess.Popen(
            root.command(text), stdout=self._log, stderr=subprocess.STDOUT, env=root.environment()
        )

    def wait(self, condition: Callable[[], object], what: str) -> float:
        """Wait until the condition holds. Return s since the start."""
        end = time.monotonic() + PATIENCE
        while True:
            try:
                if condition():
                    return time.monotonic() - self._began
            except httpx.TransportError:
                pass
            output = Path(self._log.name).read_text(errors="replace")[-1500:]
            assert self._process.poll() is None, f"mucat run ended: {output}"
            assert time.monotonic() < end, f"no {what} within {PATIENCE:g} s: {output}"
            time.sleep(0.2)

    def wait_for_page(self) -> float:
        """Return s from the start to the page."""
        return self.wait(lambda: httpx.get(self.url, timeout=30).status_code == 200, "page")

    def wait_for_health(self) -> float:
        """Return s from the start to a health of ok."""
        return self.wait(lambda: self.api.get("/health").json()["status"] == "ok", "health of ok")

    def arm(self) -> None:
        """Arm as soon as it may."""
        self.wait(
            lambda: self.api.post("/robot/commands/arm", json={"unwatched": 0}).status_code == 204, "arming"
        )

    def wait_for_recording(self, seconds: float) -> dict[str, Any]:
        """Return the session that is recorded, once it is so long."""
        recording: dict[str, Any] = {}

        def has_recorded() -> bool:
            for session in self.api.get("/sessions").json():
                if session["state"] == "recording":
                    recording.update(session)
            return float(recording.get("duration") or 0.0) >= seconds

        self.wait(has_recorded, f"recording of {seconds:g} s")
        return recording

    def processes(self) -> dict[str, psutil.Process]:
        """Return the processes that a robot has, by name."""
        runner = psutil.Process(self._process.pid)
        (server,) = [process for process in runner.children() if process.name() == "mucat-server"]
        runtime = psutil.Process(running_parts(DataFolder(self.data).run)["runtime"].pid)
        (vision,) = runtime.children()
        return {"runner": runner, "server": server, "runtime": runtime, "vision": vision}

    def end(self) -> None:
        """Press Ctrl-C."""
        self.api.close()
        self._process.send_signal(signal.SIGINT)
        try:
            self._process.wait(60.0)
        finally:
            self._process.kill()
            self._log.close()
