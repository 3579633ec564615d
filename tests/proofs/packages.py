"""`python -m tests.proofs.packages [ROOT ...]`: the wheels in fresh systems of other architectures.

In each root file system: install by pip; `mucat run` in mode robot, its serial port the line of the emulated
board outside; arm, record, export; the page fetched by Chromium from outside; processor time and memory with
one viewer; `mucat doctor`. Where the emulated board is packaged for the system, a second run swims with
that. Prints figures; status 1 where something fails.
"""

import json
import subprocess
import sys
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path

import httpx
from playwright.sync_api import expect

from bench.real_robot import pids
from server import VERSION
from server.features.bench.live_viewer import LiveViewer
from server.features.bench.process_figures import anonymous_mb, core_percent
from server.platform.settings import DataFolder
from tests.browser.opening import DESKTOP, launched, opened_page, signed_in
from tests.documents.blocks import read_blocks
from tests.proofs.installed import (
    DATA,
    ENVIRONMENT,
    MUCAT,
    PLACE,
    InstalledRobot,
    config_with_board,
    install_wheels,
)
from tests.proofs.roots import ROOTS, RootSystem

ARMED = 20.0
"""s of recording."""
SETTLE, MEASURED = 5.0, 30.0
"""s with a viewer, before and while processor time is measured."""
ONE_LINE, TOOLS = "One line, with pipx or uv", "/opt/tools"
COMMANDS: tuple[tuple[str, ...], ...] = (("--version",), ("sessions", "list"))
"""Commands of mucat that must work in each root, after the run."""


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
    one_line: dict[str, float] = field(default_factory=dict)
    """s that pipx and uv take for all packages and a command, from nothing."""
    camera: dict[str, str] = field(default_factory=dict)
    firmware: str = ""
    problem: str = ""


def prove(root: RootSystem) -> Figures:
    """Install, run and judge one root."""
    figures = Figures(root.name)
    try:
        root.make()
        figures.installed = install_wheels(root)
        figures.megabytes = _megabytes(root)
        with config_with_board(root.baud) as config:
            _swim(root, figures, "robot", config)
        machine = EMULATORS.get(root.architecture)
        if machine and list(Path("dist").glob(f"mucat_emulator-*_{machine}.whl")):
            pip = [f"{ENVIRONMENT}/bin/pip", "install", "--quiet", "--no-deps", "--find-links", "/wheels"]
            root.run(*pip, f"mucat-emulator=={VERSION}")
            if not root.is_emulated:  # two emulators within each other are too slow for real time
                _swim(root, figures, "emulated", None)
                _run_in_one_line(root, figures)
        for text in COMMANDS:
            root.run(MUCAT, *text, *(("--data", f"/{DATA}") if text != ("--version",) else ()))
    except (AssertionError, OSError, subprocess.SubprocessError, httpx.HTTPError) as problem:
        figures.problem = str(problem) or type(problem).__name__
    return figures


def _run_in_one_line(root: RootSystem, figures: Figures) -> None:
    """Run the lines of the page for who installs nothing."""
    (block,) = [block for block in read_blocks("run/packages.md") if block.title == ONE_LINE]
    root.run("sh", "-euc", f"python3 -m venv {TOOLS}; {TOOLS}/bin/pip install --quiet pipx uv")
    for line in block.text.splitlines():
        began = time.monotonic()
        answer = root.run(
            "sh",
            "-euc",
            f"cd {PLACE}; PATH={TOOLS}/bin:$PATH; {line.replace('mucat run', 'mucat --version')}",
        )
        assert VERSION in answer, answer
        figures.one_line[line.partition(" ")[0]] = round(time.monotonic() - began, 1)


EMULATORS = {"amd64": "x86_64", "i386": "i686", "arm64": "aarch64"}


def _megabytes(root: RootSystem) -> float:
    compilers = root.run("sh", "-c", "command -v gcc node cc || true")
    assert not compilers, f"there is {compilers}"
    return float(root.run("du", "-sm", ENVIRONMENT).split()[0])


def _swim(root: RootSystem, figures: Figures, mode: str, config: str | None) -> None:
    robot = InstalledRobot(root, config)
    try:
        figures.page[mode] = robot.wait_for_page()
        figures.ready[mode] = robot.wait_for_health()
        robot.arm()
        recording = robot.wait_for_recording(ARMED)
        _look(robot)
        if mode == "robot":
            _measure(robot, figures)
        state = robot.api.get("/robot").json()
        assert state["armed"], f"disarmed by itself: {state}"
        figures.camera[mode] = state["camera"]
        robot.api.post("/robot/stop").raise_for_status()
        if config is not None:
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
    with LiveViewer(DataFolder(robot.data)):
        processes = robot.processes()
        time.sleep(SETTLE)
        percent = core_percent(pids(processes), MEASURED)
        for name, process in processes.items():
            figures.percent[name] = round(percent[name], 1)
            figures.anonymous[name] = round(anonymous_mb(process.pid), 1)


def _look(robot: InstalledRobot) -> None:
    """Open the page by Chromium, signed in as an operator, while the robot is armed."""
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
