"""The pages "add a ...": each step is applied to a copy of the tree, each command is run in it."""

import os
import subprocess
import sys
import sysconfig
from collections.abc import Mapping
from pathlib import Path

import pytest

from robot_runtime.contract.packets import Debug, DebugLevel
from tests.board.host import BAUD, EmulatedRobot, all_of
from tests.board.rig import OPTIBOOT, BoardRig
from tests.documents.blocks import apply, read_blocks
from tests.sources import copy_sources

ROOT = Path(__file__).parents[2]
LINKED = (".venv", "build", "frontend/node_modules")
"""Folders that are built or installed: the copy uses those of the tree."""


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A copy of the files under version control, with the build products."""
    copy = tmp_path / "tree"
    copy_sources(copy)
    for name in LINKED:
        (copy / name).symlink_to(ROOT / name)
    return copy


def follow(page: str, tree: Path, environment: Mapping[str, str] | None = None) -> None:
    """Apply the page's blocks from first to last."""
    for block in read_blocks(page):
        if block.title:
            apply(block, tree)
        elif block.language == "sh":
            for line in block.text.splitlines():
                run(line, tree, environment)


def run(line: str, tree: Path, environment: Mapping[str, str] | None = None) -> str:
    """Run a line of the shell, which succeeds; return its output."""
    done = subprocess.run(
        line, shell=True, cwd=tree, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, f"{line}\n{done.stdout}{done.stderr}"
    return done.stdout


def changed_modules(page: str) -> list[str]:
    """Return the modules of the product that the page creates or changes."""
    titles = dict.fromkeys(block.title for block in read_blocks(page) if block.title)
    return [title for title in titles if title.startswith(("robot_runtime/", "server/", "frontend/"))]


def test_a_packet_is_added(tree: Path) -> None:
    follow("develop/add-a-packet.md", tree)
    assert "struct __attribute__((packed)) Leak" in (tree / "firmware/src/packets.gen.h").read_text()
    assert "  leak: LeakRow;" in (tree / "frontend/src/generated/topics.ts").read_text()
    assert "## Leak\n" in (tree / "docs/reference/packets.md").read_text()
    assert len(changed_modules("develop/add-a-packet.md")) == 2


def test_a_topic_is_added(tree: Path) -> None:
    follow("develop/add-a-topic.md", tree)
    assert "  say: RobotEvent;" in (tree / "frontend/src/generated/topics.ts").read_text()
    assert "what the robot says" in (tree / "docs/reference/topics.md").read_text()
    assert len(changed_modules("develop/add-a-topic.md")) == 1


def test_a_command_is_added(tree: Path) -> None:
    follow("develop/add-a-command.md", tree)
    reference = (tree / "docs/reference/commands.md").read_text()
    assert "| [say](#say) | yes | control |" in reference
    assert "## say\n" in reference
    assert len(changed_modules("develop/add-a-command.md")) == 2


def test_a_debug_line_is_added(tree: Path, tmp_path: Path) -> None:
    # Its firmware is built into the copy: that of the tree belongs to other tests.
    (tree / "build").unlink()
    follow("develop/add-a-debug-line.md", tree)
    firmware = tree / "build/firmware/robot.elf"
    with BoardRig(firmware, tmp_path, "--bootloader", str(OPTIBOOT), baud=BAUD) as rig:
        board = EmulatedRobot(rig)
        board.listen(0.3)
        board.greet()
        lines = [packet for packet in all_of(board.converse(3.0), Debug) if packet.level == DebugLevel.INFO]
    assert sum("thousand" in line.text for line in lines) >= 2, lines


def test_a_driver_is_added(tree: Path) -> None:
    # Firmware and boards are built into the copy: those of the tree belong to other tests.
    (tree / "build").unlink()
    follow("develop/add-a-driver.md", tree)
    pins = (tree / "docs/run/hardware/wiring.md").read_text()
    assert "| A0 | PC0 | input | light sensor OUT |" in pins
    assert "  light: LightRow;" in (tree / "frontend/src/generated/topics.ts").read_text()


def test_a_controller_is_added(tree: Path) -> None:
    follow("develop/add-a-controller.md", tree)
    reference = (tree / "docs/reference/parameters.md").read_text()
    assert "| `depth.proportional.kp` | 0 to 20 1/m | 2 | command for each metre of error |" in reference
    assert len(changed_modules("develop/add-a-controller.md")) == 2


def test_a_leaf_is_added(tree: Path) -> None:
    follow("develop/add-a-leaf.md", tree)
    reference = (tree / "docs/reference/missions.md").read_text()
    assert "- `yaw` (number, 0.1 to 1; without it 0.5): share of the full command\n" in reference
    assert len(changed_modules("develop/add-a-leaf.md")) == 2


def test_a_route_is_added(tree: Path) -> None:
    follow("develop/add-a-route.md", tree)
    reference = (tree / "docs/reference/http.md").read_text()
    assert "- `GET /api/link/speed` (viewer; gives `LinkSpeed`):" in reference
    assert len(changed_modules("develop/add-a-route.md")) == 1


def test_a_panel_is_added(tree: Path) -> None:
    follow("develop/add-a-panel.md", tree)
    built = [file.read_text() for file in (tree / "server/page/assets").glob("*.js")]
    assert any("Water temperature" in script for script in built)
    assert len(changed_modules("develop/add-a-panel.md")) == 3


@pytest.fixture
def environment(tree: Path, tmp_path: Path) -> Mapping[str, str]:
    """The environment of a shell with `pip` and `mucat` of a virtual environment beside that of the tests."""
    venv = tmp_path / "venv"
    run(f"{sys.executable} -m venv --without-pip {venv}", tmp_path)
    (packages,) = venv.glob("lib/python*/site-packages")
    (packages / "tests.pth").write_text(f"{sysconfig.get_path('purelib')}\n", encoding="utf-8")
    python = venv / "bin/python"
    scripts = {
        "pip": f'exec {ROOT}/.venv/bin/uv pip "$@" --quiet --python {python} --offline',
        "mucat": f'exec {python} -m server.cli "$@"',
    }
    for name, line in scripts.items():
        script = venv / "bin" / name
        script.write_text(f"#!/bin/sh\n{line}\n", encoding="utf-8")
        script.chmod(0o755)
    return os.environ | {"PATH": f"{venv}/bin:{os.environ['PATH']}", "PYTHONPATH": str(tree)}


def test_a_feature_is_installed_used_and_removed(
    tree: Path, tmp_path: Path, environment: Mapping[str, str]
) -> None:
    follow("develop/add-a-feature.md", tree, environment)
    run(f"python -m tests.documents.outside_feature {tmp_path / 'data'}", tree, environment)
    assert changed_modules("develop/add-a-feature.md") == []
    run("pip uninstall mucat-lines", tree, environment)
    assert "lines" not in run("mucat --help", tree, environment)
