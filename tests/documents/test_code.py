"""Every block of Python, shell and TOML in the documents is run, or it is on a list with a reason."""

import asyncio
import subprocess
import sys
import tempfile
from collections.abc import AsyncIterator, Callable
from pathlib import Path

import pytest

from robot_runtime.contract.craft import read_craft
from robot_runtime.contract.packets import Depth
from robot_runtime.contract.topics import DEPTH
from robot_runtime.experiments.scenario.document import DEFAULT_CRAFT
from robot_runtime.experiments.scenario.library import shipped_scenarios
from robot_runtime.missions.document import read_mission
from server.features.sweeps.order import read_document
from server.health.monitor import HealthMonitor
from server.platform.settings import Settings, read_settings
from tests.documents import test_commands, test_recipes
from tests.documents.blocks import DOCS, CodeBlock, read_blocks
from tests.notebooks.runner import NAMES, read_cells
from tests.server.blocks import debug_block
from tests.server.conftest import settings as settings
from tests.server.features.doors.rig import OPEN, make_token, rows_block
from tests.server.serving import Served, serve
from tests.server.waiting import until

LANGUAGES = frozenset({"py", "python", "sh", "bash", "toml"})
PYTHON = frozenset({"py", "python"})
PI_32_BITS = (
    "sudo apt install python3-venv python3-numpy python3-opencv python3-pydantic python3-libgpiod "
    "python3-picamera2 avrdude"
)
PIPX = (
    'pipx run --spec "$(echo ./mucat-*.whl)[emulator]" --pip-args="--find-links . -c constraints.txt" '
    "mucat run"
)
DASK = (
    "dask scheduler --protocol tls --port 8786 --tls-ca-file ca.pem --tls-cert certificate.pem "
    "--tls-key key.pem"
)
UNRUN = {
    ("../README.md", "pip install -c constraints.txt ./mucat-*.whl ./mucat_emulator-*_$(uname -m).whl"): (
        "it installs into the system; tests/packages installs the same wheels"
    ),
    ("develop/add-a-topic.md", "self.bus.publish_document(SAY, event)"): "a line of a method",
    ("run/computers.md", "mucat bench"): "a minute beside a robot; tests/server/features/bench measures one",
    (
        "run/lab.md",
        "mucat lab run --data /srv/mucat-lab",
    ): "tests/server/features/lab serves one",
    ("run/lab.md", "mucat lab lake lake --topics control depth --data /srv/mucat-lab"): (
        "an archive; tests/server/features/exports/test_lake.py makes one"
    ),
    ("run/lab.md", "mucat backup lab.db --data /srv/mucat-lab"): (
        "two labs; tests/server/features/backup/test_archive_backup.py has them"
    ),
    ("run/lab.md", "pip install mucat[lab]"): "the internet; tests/server/postgres.py has a server",
    ("run/packages.md", PIPX): "the internet; tests/proofs/packages.py runs both lines",
    ("run/packages.md", "python3 -m venv mucat"): "tests/packages does the same with the wheels",
    ("run/packages.md", "sudo apt install python3-venv python3-picamera2 avrdude"): "a Raspberry Pi",
    ("run/packages.md", PI_32_BITS): "a Raspberry Pi of 32 bits",
    ("run/packages.md", "python3 -m pip download -d wheels -c constraints.txt ./mucat-*.whl"): "the internet",
    ("run/sd-card.md", "sudo sh mucat-*/install.sh --dry-run"): "an installed robot, see `make services`",
    ("run/sd-card.md", "sudo mucat doctor"): "an installed robot",
    ("run/sd-card.md", "sudo mucat record start pool"): "an installed robot",
    ("run/troubleshoot.md", "systemctl --no-pager --lines 5 status mucat-runtime mucat"): "systemd",
    ("run/packages.md", "pip install ./mucat_client-*.whl"): "tests/packages/test_client.py installs it",
    ("use/learn.md", "pip install mucat[gym]"): "the internet",
    ("use/sweeps.md", "from mucat import Lab"): "the notebook sweep does the same",
    ("use/sweeps.md", DASK): "tests/server/features/sweeps/test_cluster.py does the same",
    ("use/notebooks/index.md", "pip install jupyterlab matplotlib pandas"): "Jupyter and the internet",
}
"""Blocks that no test runs, by page and first line, and what they would need. Their syntax is checked.
Options of `mucat` in them are checked, too (test_commands.py)."""


def pages() -> list[str]:
    results = [str(page.relative_to(DOCS)) for page in sorted(DOCS.rglob("*.md"))]
    return ["../README.md", "../CONTRIBUTING.md", "../SECURITY.md", *results]


def blocks(languages: frozenset[str] = LANGUAGES) -> list[tuple[str, CodeBlock]]:
    return [(page, block) for page in pages() for block in read_blocks(page) if block.language in languages]


def named(page: str, block: CodeBlock) -> tuple[str, str]:
    return page, block.text.splitlines()[0]


def read_robot_file(text: str) -> None:
    """Read a part of robot.toml as a server does."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "robot.toml"
        path.write_text(text, encoding="utf-8")
        read_settings(path, Path(folder), None, None, {})


def read_sweep_of_the_library(text: str) -> None:
    """Check a sweep as a server does."""
    read_document(text, shipped_scenarios(), DEFAULT_CRAFT)


READERS: dict[str, Callable[[str], object]] = {
    "reference/craft.md": read_craft,
    "run/proxy.md": read_robot_file,
    "use/doors.md": read_robot_file,
    "use/events.md": read_robot_file,
    "use/missions.md": read_mission,
    "use/sweeps.md": read_sweep_of_the_library,
}


def is_run(page: str, block: CodeBlock) -> bool:
    """Return True for a block that some test runs as it stands."""
    if block.language == "toml":
        return page in READERS or bool(block.title)
    if page.startswith("develop/add-a-") and (block.title or block.language == "sh"):
        return True
    if block.language in PYTHON:
        return page in ON_A_SERVER or page in ("use/export.md", "use/learn.md")
    return block.language == "sh" and page in test_commands.RUN


def test_every_block_is_run_or_on_the_list() -> None:
    remaining = {named(page, block) for page, block in blocks() if not is_run(page, block)}
    assert remaining == UNRUN.keys()


def test_every_recipe_is_followed() -> None:
    text = Path(test_recipes.__file__).read_text(encoding="utf-8")
    for page in pages():
        assert not page.startswith("develop/add-a-") or f'follow("{page}"' in text, page


def test_the_syntax_of_what_is_not_run_is_right() -> None:
    for page, block in blocks():
        if is_run(page, block):
            continue
        if block.language in PYTHON:
            compile(block.text, page, "exec")
        else:
            done = subprocess.run(
                ["bash", "-n"], input=block.text, text=True, capture_output=True, check=False
            )
            assert done.returncode == 0, (page, done.stderr)


@pytest.mark.parametrize("page", READERS)
def test_the_toml_of_a_page_is_read_by_its_reader(page: str) -> None:
    results = [block for block in read_blocks(page) if block.language == "toml"]
    assert results
    for block in results:
        READERS[page](block.text)


NOTEBOOKS = {f"use/notebooks/{name}.md": name for name in NAMES}
PRELUDE = """
from mucat import Robot
robot, best, gains = Robot("http://turtle.local:8000", "mucat_..."), "hard", {"hard": (9.0, 0.4, 2.0)}
"""
"""What the cells before have made, for the blocks of a notebook's text."""
ON_A_SERVER = ("develop/add-a-debug-line.md", "use/doors.md", *NOTEBOOKS)


def test_the_cells_of_a_notebook_are_the_blocks_of_its_page() -> None:
    for page, name in NOTEBOOKS.items():
        cells = [cell.source.strip() for cell in read_cells(name) if cell.kind == "code"]
        there = [block.text.strip() for block in read_blocks(page) if block.language in PYTHON]
        assert [text for text in there if text in cells] == cells


def programs() -> list[str]:
    """Return the programs of these pages that no notebook runs."""
    results = []
    for page in ON_A_SERVER:
        name = NOTEBOOKS.get(page)
        cells = [cell.source.strip() for cell in read_cells(name)] if name else []
        prelude = PRELUDE if name else ""
        results += [
            prelude + block.text
            for block in read_blocks(page)
            if block.language in PYTHON and block.text.strip() not in cells
        ]
    return results


@pytest.fixture
async def served(settings: Settings) -> AsyncIterator[Served]:
    """A server with open doors."""
    async with serve(settings.with_section(OPEN)) as served:
        yield served


@pytest.mark.parametrize("program", programs(), ids=lambda text: text.strip().splitlines()[0])
async def test_a_program_runs(program: str, served: Served) -> None:
    session = (await served.api.post("/sessions", json={"name": "Dive"})).json()["id"]
    await served.api.post("/control/release")
    diving = asyncio.create_task(dive(served))
    await until(lambda: DEPTH in served.get(HealthMonitor)._newest, "the depth")
    await served.api.post(f"/sessions/{session}/stop")
    address = f"127.0.0.1:{served.settings.server.port}"
    code = program.replace("turtle.local:8000", address).replace("mucat_...", await make_token(served))
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-u", "-c", code, stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.PIPE
    )
    assert process.stdout is not None
    first = await process.stdout.readline() if "print" in code else b""
    if "roslibpy" in code:
        # It listens until it is ended.
        process.terminate()
    output, problem = await process.communicate()
    diving.cancel()
    if "roslibpy" in code:
        assert float(first) == pytest.approx(1.2)
    else:
        assert process.returncode == 0, (output, problem.decode())


async def dive(served: Served) -> None:
    """A robot at 1.2 m, which sends its depth and a line of its firmware ten times a second."""
    number = 0
    while True:
        depth = Depth(time=number, depth=1.2, pressure=113_000, temperature=18.5)
        now = served.container.clock.now()
        served.runtime.publish(rows_block("depth", number, (now, depth)))
        served.runtime.publish(debug_block(number, "passes: 40 thousand", start=now - number))
        number += 1
        await asyncio.sleep(0.1)
