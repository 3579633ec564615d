"""`python -m tests.proofs.packages [ROOT ...]`: the wheels in fresh systems of other architectures.

In each root file system: install by pip; `mucat run` in mode robot, its serial port the line of the emulated
board outside; arm, record, export; the page fetched by Chromium from outside; processor time and memory with
one viewer; `mucat doctor`. Where the emulated board is packaged for the system, a second run swims with
that. Prints figures; status 1 where something fails.
"""

import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import httpx
import psutil
from playwright.sync_api import expect

from bench.processes import anonymous_mb, cpu_seconds
from bench.real_robot import LiveViewer, store_picture
from robot_runtime.places import BUILD
from robot_runtime.simulation.boards.emulator_process import EmulatorProcess
from robot_runtime.simulation.boards.firmware import build_firmware, firmware_path
from server import VERSION
from server.platform.pidfile import running_parts
from server.platform.settings import DataFolder
from tests.browser.opening import DESKTOP, launched, opened_page, signed_in
from tests.control import Commander
from tests.documents.blocks import read_blocks
from tests.proofs.roots import ROOTS, RootSystem
from tests.shell import ShellToken
from tests.stack import free_port

BAUD = 115_200
"""bit/s; qemu's emulation of Linux cannot set 250000."""
PATIENCE = 300.0
"""s; a foreign processor is emulated, some fifteen times slower."""
ARMED = 20.0
"""s of recording."""
SETTLE, MEASURED = 5.0, 30.0
"""s with a viewer, before and while processor time is measured."""
PLACE = "/opt/release"
ENVIRONMENT = f"{PLACE}/mucat"
MUCAT = f"{ENVIRONMENT}/bin/mucat"
DATA = "var/lib/mucat"
COMMANDS: tuple[tuple[str, ...], ...] = (("--version",), ("sessions", "list"))
"""Commands of mucat that must work in each root, after the run."""
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


@dataclass
class Figures:
    """The course of an installation; times in s."""

    root: str
    installed: float = 0.0
    megabytes: float = 0.0
    page: dict[str, float] = field(default_factory=dict)
    """From the start to the page, by mode."""
    ready: dict[str, float] = field(default_factory=dict)
    """From the start to a health of ok, by mode."""
    samples: dict[str, int] = field(default_factory=dict)
    alarms: dict[str, list[str]] = field(default_factory=dict)
    percent: dict[str, float] = field(default_factory=dict)
    """Of a core, by process of a robot: armed, recording, one viewer."""
    anonymous: dict[str, float] = field(default_factory=dict)
    """MB of anonymous memory at the end of that; with the emulator of the processor, where there is one."""
    exported: int = 0
    """Bytes of the exported file."""
    camera: dict[str, str] = field(default_factory=dict)
    firmware: str = ""
    problem: str = ""


class InstalledRobot:
    """`mucat run` in a root, seen from outside."""

    def __init__(self, root: RootSystem, config: str | None) -> None:
        self.port = free_port()
        self.url = self.first = f"http://127.0.0.1:{self.port}"
        self.data = root.path / DATA
        self.api = Commander(base_url=f"{self.url}/api", timeout=60.0, auth=ShellToken(DataFolder(self.data)))
        words = [MUCAT, "run", "--port", str(self.port), "--data", f"/{DATA}"]
        if config is not None:
            (root.path / "etc/robot.toml").write_text(config)
            store_picture(root.path / "etc/card.png")
            words += ["--config", "/etc/robot.toml"]
        self._log = (root.path / "var/log/mucat.log").open("wb")
        self._began = time.monotonic()
        self._process = subprocess.Popen(
            root.command(words), stdout=self._log, stderr=subprocess.STDOUT, env=root.environment()
        )

    def wait(self, condition: Callable[[], object], what: str) -> float:
        """Waits until the condition holds. Returns s since the start."""
        end = time.monotonic() + PATIENCE
        while True:
            try:
                if condition():
                    return time.monotonic() - self._began
            except httpx.TransportError:
                pass
            said = Path(self._log.name).read_text(errors="replace")[-1500:]
            assert self._process.poll() is None, f"mucat run ended: {said}"
            assert time.monotonic() < end, f"no {what} within {PATIENCE:g} s: {said}"
            time.sleep(0.2)

    def processes(self) -> dict[str, psutil.Process]:
        """The processes that a robot has, by name."""
        runner = psutil.Process(self._process.pid)
        (server,) = [one for one in runner.children() if one.name() == "mucat-server"]
        runtime = psutil.Process(running_parts(DataFolder(self.data).run)["runtime"].pid)
        return {"runner": runner, "server": server, "runtime": runtime}

    def end(self) -> None:
        """Presses Ctrl-C."""
        self.api.close()
        self._process.send_signal(signal.SIGINT)
        try:
            self._process.wait(60.0)
        finally:
            self._process.kill()
            self._log.close()


def prove(root: RootSystem) -> Figures:
    """Installs, runs and judges one root."""
    figures = Figures(root.name)
    try:
        root.make()
        _install(root, figures)
        with _board() as port:
            _swim(root, figures, "robot", CONFIG.format(port=port, baud=BAUD))
        machine = EMULATORS.get(root.architecture)
        if machine and list(Path("dist").glob(f"mucat_emulator-*_{machine}.whl")):
            pip = [f"{ENVIRONMENT}/bin/pip", "install", "--quiet", "--no-deps", "--find-links", "/wheels"]
            root.run(*pip, f"mucat-emulator=={VERSION}")
            if not root.interpreter:  # two emulators within each other are too slow for real time
                _swim(root, figures, "emulated", None)
        for words in COMMANDS:
            root.run(MUCAT, *words, *(("--data", f"/{DATA}") if words != ("--version",) else ()))
    except (AssertionError, OSError, subprocess.SubprocessError, httpx.HTTPError) as problem:
        figures.problem = str(problem) or type(problem).__name__
    return figures


EMULATORS = {"amd64": "x86_64", "i386": "i686", "arm64": "aarch64"}


def _install(root: RootSystem, figures: Figures) -> None:
    began = time.monotonic()
    root.run("rm", "-rf", PLACE, f"/{DATA}")
    root.run("mkdir", "-p", PLACE)
    (block,) = [one for one in read_blocks("run/packages.md") if one.title == root.page]
    # apt has installed its part when the root was made.
    lines = [line for line in block.text.splitlines() if not line.startswith(("sudo apt", "mucat/bin/mucat"))]
    assert len(lines) == 2, f"the page has {lines}"
    root.run("sh", "-euc", "\n".join([f"cd {PLACE}", "ln -s /wheels/* .", *lines]))
    figures.installed = time.monotonic() - began
    compilers = root.run("sh", "-c", "command -v gcc node cc || true")
    assert not compilers, f"there is {compilers}"
    size = root.run("du", "-sm", ENVIRONMENT)
    figures.megabytes = float(size.split()[0])


@contextmanager
def _board() -> Iterator[str]:
    """The emulated board and its water, outside; yields the serial port."""
    build_firmware(BUILD, BAUD)
    elf = firmware_path(BUILD, BAUD, ".elf")
    with TemporaryDirectory(prefix="mucat-") as name:
        tty, socket = Path(name) / "tty", Path(name) / "socket"
        with EmulatorProcess(BUILD / "board", elf, tty, socket, "--with-parent"):
            water = [
                sys.executable,
                "-m",
                "robot_runtime.simulation",
                "--board",
                str(socket),
                "--with-parent",
            ]
            with subprocess.Popen(water) as simulator:
                try:
                    yield str(tty.resolve())
                finally:
                    simulator.terminate()


def _swim(root: RootSystem, figures: Figures, mode: str, config: str | None) -> None:
    robot = InstalledRobot(root, config)
    try:
        figures.page[mode] = robot.wait(lambda: httpx.get(robot.url, timeout=30).status_code == 200, "page")
        figures.ready[mode] = robot.wait(
            lambda: robot.api.get("/health").json()["status"] == "ok", "health of ok"
        )
        robot.wait(lambda: robot.api.post("/robot/commands/arm").status_code == 204, "arming")
        recording: dict[str, Any] = {}

        def has_recorded() -> bool:
            for session in robot.api.get("/sessions").json():
                if session["state"] == "recording":
                    recording.update(session)
            return float(recording.get("duration") or 0.0) >= ARMED

        robot.wait(has_recorded, f"recording of {ARMED:g} s")
        _look(robot)
        if mode == "robot":
            _measure(robot, figures)
        state = robot.api.get("/robot").json()
        assert state["armed"], f"disarmed by itself: {state}"
        figures.camera[mode] = state["camera"]
        robot.api.post("/robot/stop").raise_for_status()
        if config is not None and not root.interpreter:
            # qemu tells a process a wrong start time of its own, by which the doctor knows its server.
            root.run(MUCAT, "doctor", "--config", "/etc/robot.toml", "--data", f"/{DATA}")
        session = robot.api.get(f"/sessions/{recording['id']}").json()
        figures.samples[mode] = session["samples"]
        figures.firmware = session["firmware"]
        figures.alarms[mode] = [alarm["text"] for alarm in state.get("alarms", [])]
        assert len(figures.firmware) == 16, "the recording does not name its firmware"
        root.run(MUCAT, "export", str(recording["id"]), "--data", f"/{DATA}", "-o", "/tmp/dive.zip")
        figures.exported = (root.path / "tmp/dive.zip").stat().st_size
    finally:
        robot.end()


def _measure(robot: InstalledRobot, figures: Figures) -> None:
    """Processor time and memory while a viewer reads everything."""
    viewer = LiveViewer(robot)
    processes = robot.processes()
    time.sleep(SETTLE)
    before = {name: cpu_seconds(process) for name, process in processes.items()}
    time.sleep(MEASURED)
    for name, process in processes.items():
        figures.percent[name] = round((cpu_seconds(process) - before[name]) / MEASURED * 100, 1)
        figures.anonymous[name] = round(anonymous_mb(process), 1)
    viewer.close()


def _look(robot: InstalledRobot) -> None:
    """Opens the page by Chromium, signed in as an operator, while the robot is armed."""
    with launched() as browser:
        cookies = signed_in(browser, robot)
        with opened_page(browser, robot, cookies, DESKTOP) as page:
            expect(page.get_by_text("Armed", exact=True).first).to_be_visible(timeout=60_000)
            page.screenshot(path=robot.data / "page.png")


def main() -> int:
    """Exit status."""
    roots = [root for root in ROOTS if not sys.argv[1:] or root.name in sys.argv[1:]]
    failed = 0
    for root in roots:
        figures = prove(root)
        failed += bool(figures.problem)
        print(json.dumps(asdict(figures), indent=2, ensure_ascii=False), flush=True)
    return 1 if failed or not roots else 0


if __name__ == "__main__":
    sys.exit(main())
