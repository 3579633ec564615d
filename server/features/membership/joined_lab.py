"""The lab that this robot has joined, as it is stored: what it knows of it, and its certificate there."""

import json
import shutil
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from robot_runtime.durable_files import make_folder, write_whole

FILE = "lab.json"


@dataclass(frozen=True, slots=True, kw_only=True)
class JoinedLab:
    """A lab; `router` is its router's Zenoh endpoint, `device` the lab's token, `joined` in s since 1970.

    `robot` is the robot's name in the lab: the one that it had when it joined.
    """

    name: str
    robot: str
    address: str
    router: str
    device: int
    joined: float


def read_lab(folder: Path) -> JoinedLab | None:
    """Return the lab stored in this folder; None without one. Raise OSError, ValueError, TypeError."""
    try:
        return JoinedLab(**json.loads((folder / FILE).read_bytes()))
    except FileNotFoundError:
        return None


def write_lab(folder: Path, lab: JoinedLab, files: Mapping[str, str]) -> None:
    """Store a lab and the files of the certificate, by their names. Raise OSError; then nothing is stored."""
    part = folder.with_suffix(".part")
    shutil.rmtree(part, ignore_errors=True)
    make_folder(part.parent)
    part.mkdir(mode=0o700)
    for name, text in {**files, FILE: json.dumps(asdict(lab), ensure_ascii=False)}.items():
        write_whole(part / name, text.encode(), 0o600)
    part.rename(folder)


def remove_lab(folder: Path) -> None:
    """Forget the lab. Raise OSError."""
    # A folder that is half removed is of no lab.
    (folder / FILE).unlink(missing_ok=True)
    shutil.rmtree(folder)
