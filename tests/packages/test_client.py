"""The client's wheel on a computer with nothing else of µ-CAT."""

import subprocess
import sysconfig
import tomllib
import zipfile
from pathlib import Path

import pytest

from packages.wheels import build_client
from robot_runtime.places import PACKAGES
from server import VERSION
from tests.packages.installation import UV
from tests.released import ARCHIVE, RELEASED

BYTES_MAX = 120_000


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel of this source."""
    return build_client(tmp_path_factory.mktemp("wheels"))


@pytest.fixture(scope="module")
def python(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The interpreter of an environment with the wheel and what it says that it depends on."""
    folder = tmp_path_factory.mktemp("client")
    subprocess.run([UV, "venv", "--quiet", str(folder)], check=True)
    python = folder / "bin/python"
    subprocess.run(
        [UV, "pip", "install", "--quiet", "--no-deps", "--python", str(python), str(wheel)], check=True
    )
    (packages,) = folder.glob("lib/python*/site-packages")
    declared = tomllib.loads((PACKAGES / "packages/client/pyproject.toml").read_text())["project"]
    for name in declared["dependencies"]:
        module = name.replace("-", "_")
        (packages / module).symlink_to(Path(sysconfig.get_path("purelib")) / module)
    return python


def run(python: Path, program: str, *arguments: str, cwd: Path) -> str:
    done = subprocess.run(
        [python, "-I", "-c", program, *arguments], capture_output=True, text=True, check=False, cwd=cwd
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_it_is_small_and_its_files_are_those_of_the_other_wheel(wheel: Path) -> None:
    assert wheel.name == f"mucat_client-{VERSION}-py3-none-any.whl"
    assert wheel.stat().st_size < BYTES_MAX
    with zipfile.ZipFile(wheel) as files:
        names = [name for name in files.namelist() if ".dist-info/" not in name]
        assert [name for name in names if files.read(name) != (PACKAGES / name).read_bytes()] == []
    assert not [name for name in names if name.startswith(("server/", "mucat/gym/"))]


def test_every_module_of_it_is_imported_without_a_server(python: Path, tmp_path: Path) -> None:
    program = """
import importlib.util, pkgutil, mucat
for module in pkgutil.walk_packages(mucat.__path__, "mucat."):
    importlib.import_module(module.name)
print(*(name for name in ("server", "fastapi", "numpy", "pandas") if importlib.util.find_spec(name)))
"""
    assert run(python, "import importlib" + program, cwd=tmp_path).strip() == ""


@pytest.mark.parametrize("version", ["0.2.0"])
def test_it_reads_an_archive_of_an_earlier_release(python: Path, tmp_path: Path, version: str) -> None:
    program = """
import sys
from mucat import RobotError, Sessions
tables = Sessions.read(sys.argv[1])
print(tables.about["version"], tables.units("depth")["depth"], len(tables.columns("depth")["depth"]) > 500)
try:
    tables.pandas("depth")
except RobotError as problem:
    print(problem)
"""
    printed = run(python, program, str(RELEASED / version / ARCHIVE), cwd=tmp_path)
    assert printed.splitlines() == [
        f"{version} m True",
        "This needs the package pandas: pip install pandas",
    ]
