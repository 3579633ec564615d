"""Copies of the source tree, in which a test may change what it likes."""

import shutil
import subprocess
from importlib.util import cache_from_source
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def copy_sources(target: Path) -> None:
    """Copy the files that are or would be under version control, as they are now."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    for name in listed.stdout.split("\0"):
        source, copy = ROOT / name, target / name
        if source.is_file():
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source, copy)
            _copy_compiled(source, copy)


def _copy_compiled(source: Path, copy: Path) -> None:
    """Copy a module's compiled form, which names its time of change: a changed module is compiled anew."""
    if source.suffix != ".py":
        return
    compiled = Path(cache_from_source(source))
    if compiled.is_file():
        path = Path(cache_from_source(copy))
        path.parent.mkdir(exist_ok=True)
        shutil.copy2(compiled, path)
